"""glTF 2.0 in ``.glb`` files: how it differs from PLY and OBJ.

Its vertex colours are in linear light, while ours are sRGB, and its surfaces are lit unless a
material says that they are not. trimesh reads and writes the files, but rounds colours to 8 bits,
which are too few for linear light: they pass it under another name, as an application's attribute.

::

    .glb   magic  version  length   JSON length  "JSON"  JSON   binary length  "BIN"  binary

References
----------
Khronos Group, "glTF 2.0 Specification", 3.7.2.1 (colours), 4.4 (GLB); KHR_materials_unlit.
IEC 61966-2-1, 1999: the transfer function of sRGB.
"""

from __future__ import annotations

import json
import struct
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from vmesh.arrays import Float64Array, SampleArray, UInt8Array, UInt16Array
from vmesh.errors import LimitError, MeshError
from vmesh.formats.models.colors import check_unit
from vmesh.limits import Limits

COLOR: Final = "_COLOR"  # the name under which colours pass

_STANDARD_COLOR: Final = "COLOR_0"
_UNLIT: Final = "KHR_materials_unlit"
_HEAD: Final = struct.Struct("<4sII I4s")  # of the file and of its first chunk
_MAGIC: Final = b"glTF"
_JSON: Final = b"JSON"
_ENTRIES_PER_VERTEX: Final = 32  # indices, and what else programs say of a vertex


def linear_from_srgb(colors: UInt8Array) -> UInt16Array:
    """RGBA of 8 bits, shape (n, 4), in linear light of 16 bits, so that each stays distinct."""
    values = colors / 255.0
    rgb = values[:, :3]
    values[:, :3] = np.where(rgb <= 0.04045, rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4)
    return np.rint(values * 65535).astype(np.uint16)


def srgb_from_linear(colors: npt.NDArray[Any]) -> UInt8Array:
    """RGBA of 8 bits, shape (n, 4), of colours in linear light: floats, or 8 or 16 bits.

    Raises
    ------
    MeshError
        If a float is not from 0 to 1.
    """
    largest = np.iinfo(colors.dtype).max if colors.dtype.kind == "u" else 1
    values: Float64Array = np.ones((len(colors), 4))
    values[:, : colors.shape[1]] = colors / largest
    check_unit(values)
    rgb = np.clip(values[:, :3], 0, 1)
    values[:, :3] = np.where(rgb <= 0.0031308, rgb * 12.92, 1.055 * rgb ** (1 / 2.4) - 0.055)
    return np.rint(255 * np.clip(values, 0, 1)).astype(np.uint8)


def finish_tree(tree: dict[str, Any], colors: SampleArray) -> None:
    """Give the JSON of a file with one surface its colours, and a material that needs no light."""
    (primitive,) = tree["meshes"][0]["primitives"]
    primitive["attributes"][_STANDARD_COLOR] = index = primitive["attributes"].pop(COLOR)
    tree["accessors"][index]["normalized"] = True
    primitive["material"] = 0
    is_opaque = (colors[:, 3] == np.iinfo(colors.dtype).max).all()
    material: dict[str, Any] = {
        "extensions": {_UNLIT: {}},
        "alphaMode": "OPAQUE" if is_opaque else "BLEND",
        "doubleSided": True,
    }
    tree["materials"] = [material]
    tree["extensionsUsed"] = [_UNLIT]


def with_renamed_colors(data: bytes, limits: Limits) -> bytes:
    """A file whose colours have the name under which they pass.

    Raises
    ------
    MeshError
        If it is no ``.glb`` file, or uses what is not read.
    LimitError
        If it speaks of more than a mesh within `limits` needs.
    """
    magic, version, _, size, kind = _HEAD.unpack(data[: _HEAD.size].ljust(_HEAD.size))
    if (magic, version, kind) != (_MAGIC, 2, _JSON):
        raise MeshError("expected the header of a .glb file of version 2")
    tree = json.loads(data[_HEAD.size : _HEAD.size + size])
    rest = data[_HEAD.size + size :]
    _check_tree(tree, limits)
    for mesh in tree["meshes"]:
        for primitive in mesh["primitives"]:
            attributes = primitive["attributes"]
            if _STANDARD_COLOR in attributes:
                attributes[COLOR] = attributes.pop(_STANDARD_COLOR)
    text = json.dumps(tree).encode()
    text += b" " * (-len(text) % 4)
    return _HEAD.pack(_MAGIC, 2, _HEAD.size + len(text) + len(rest), len(text), _JSON) + text + rest


def _check_tree(tree: dict[str, Any], limits: Limits) -> None:
    """Refuse what is not read, and counts that would ask for memory without end."""
    if required := set(tree.get("extensionsRequired", ())) - {_UNLIT}:
        raise MeshError(f"it needs the extension {min(required)}, which is not read")
    if any("uri" in buffer for buffer in tree["buffers"]):
        raise MeshError("its data are in another file: expected all of them in the .glb file")
    accessors = tree["accessors"]
    if any("sparse" in item or "bufferView" not in item for item in accessors):
        raise MeshError("it has sparse accessors, which are not read")
    n_entries = sum(abs(int(item["count"])) for item in accessors)
    if n_entries > limits.max_vertices * _ENTRIES_PER_VERTEX:
        raise LimitError(
            f"the file has {n_entries} entries, but the limit is {_ENTRIES_PER_VERTEX} "
            f"for each of at most {limits.max_vertices} vertices"
        )
