"""``python -m vmesh``."""

from vmesh.cli.main import main

main()
