"""Formats of files by their content: what cannot be read is named, with what to do about it."""

from __future__ import annotations

from typing import Final

# Four letters that say what a file of ISO base media is, by ISO/IEC 23008-12 and the registry
# at https://mp4ra.org/registered-types/brands.
_HEIF_BRANDS: Final = frozenset(
    (b"heic", b"heix", b"heim", b"heis", b"hevc", b"hevx", b"hevm", b"hevs", b"mif1", b"msf1")
)
_AVIF_BRANDS: Final = frozenset((b"avif", b"avis"))
_JXL_CODESTREAM: Final = b"\xff\x0a"
_JXL_CONTAINER: Final = b"\0\0\0\x0cJXL \r\n\x87\n"

_RAW: Final = "a raw file of a camera, which has to be developed first; export a JPEG, PNG or TIFF"
_EXPORT: Final = "export a PNG, JPEG or TIFF"
_VIDEO: Final = "a video, not a photograph; save one of its frames as a PNG"
_VECTOR: Final = "a drawing and not a photograph; export a PNG"

# Where a signature stands, the signature, and what the file is.
_SIGNATURES: Final = (
    (0, b"%PDF-", "a PDF document; export its page as a PNG"),
    (0, b"%!PS", "a PostScript document; export its page as a PNG"),
    (0, b"\xc5\xd0\xd3\xc6", "an EPS document; export it as a PNG"),
    (0, b"8BPS", f"a Photoshop document (PSD), which is not read; {_EXPORT}"),
    (0, b"gimp xcf ", f"a GIMP document (XCF), which is not read; {_EXPORT}"),
    (0, b"SIMPLE  =", f"a FITS file, which is not read; {_EXPORT}"),
    (0, b"\x76\x2f\x31\x01", f"an OpenEXR picture, which is not read; {_EXPORT}"),
    (0, b"#?RADIANCE", f"a Radiance HDR picture, which is not read; {_EXPORT}"),
    (0, b"#?RGBE", f"a Radiance HDR picture, which is not read; {_EXPORT}"),
    (0, b"II\xbc\x01", f"a JPEG XR picture, which is not read; {_EXPORT}"),
    (0, b"icns", f"an icon of macOS (ICNS), which is not read; {_EXPORT}"),
    (0, b"DDS ", f"a DirectDraw texture (DDS), which is not read; {_EXPORT}"),
    (0, b"AT&TFORM", "a DjVu document; export its page as a PNG"),
    (0, b"BPG\xfb", f"a BPG picture, which is not read; {_EXPORT}"),
    (0, b"FUJIFILMCCD-RAW", _RAW),
    (0, b"IIU\0", _RAW),
    (0, b"IIRO", _RAW),
    (0, b"IIRS", _RAW),
    (0, b"MMOR", _RAW),
    (0, b"\0MRM", _RAW),
    (0, b"FOVb", _RAW),
    (0, b"HEAPCCDR", _RAW),
    (8, b"CR\x02\0", _RAW),
    (6, b"HEAPCCDR", _RAW),
    (0, b"\x1aE\xdf\xa3", _VIDEO),
    (0, b"\0\0\x01\xba", _VIDEO),
    (0, b"\0\0\x01\xb3", _VIDEO),
    (8, b"AVI ", _VIDEO),
    (8, b"WAVE", "a sound, not a photograph"),
    (0, b"ID3", "a sound, not a photograph"),
    (0, b"OggS", "a sound or a video, not a photograph"),
    (0, b"fLaC", "a sound, not a photograph"),
    (0, b"\x1f\x8b", "a compressed file (gzip); unpack it first"),
    (0, b"PK\x03\x04", "an archive or an office document (ZIP); take the picture out of it first"),
    (0, b"7z\xbc\xaf\x27\x1c", "an archive (7z); unpack it first"),
    (0, b"Rar!\x1a\x07", "an archive (RAR); unpack it first"),
    (0, b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1", "an office document; export the picture as a PNG"),
    (0, b"glTF", "a model (glTF); vmesh import reads it"),
    (0, b"ply\n", "a model (PLY); vmesh import reads it"),
    (0, b"ply\r", "a model (PLY); vmesh import reads it"),
    (0, b"\xd7\xcd\xc6\x9a", f"a Windows metafile, {_VECTOR}"),
)
_MARKUP_STARTS: Final = 1024  # bytes in which a document says what it is


def is_heif(data: bytes) -> bool:
    """True of HEIC and HEIF, by their brand; a major brand of AVIF goes before others."""
    brands = _brands(data)
    return bool(brands) and brands[0] not in _AVIF_BRANDS and not _HEIF_BRANDS.isdisjoint(brands)


def is_avif(data: bytes) -> bool:
    """True of AVIF, by its brand."""
    return not _AVIF_BRANDS.isdisjoint(_brands(data))


def is_jxl(data: bytes) -> bool:
    """True of JPEG XL, bare or in a container."""
    return data.startswith((_JXL_CODESTREAM, _JXL_CONTAINER))


def describe_foreign(data: bytes) -> str | None:
    """Words that say what a file is that is no picture we read, None if nobody knows.

    They go on after "this is".
    """
    for offset, signature, words in _SIGNATURES:
        if data.startswith(signature, offset):
            return words
    brands = _brands(data)
    if brands:
        return _RAW if brands[0] == b"crx " else _VIDEO
    start = data[:_MARKUP_STARTS].lstrip(b"\xef\xbb\xbf \t\r\n").lower()
    if start.startswith(b"<svg") or (start.startswith(b"<") and b"<svg" in start):
        return f"an SVG file, {_VECTOR}"
    if start.startswith((b"<!doctype html", b"<html")):
        return "a web page, not a photograph; perhaps a download that went wrong"
    if start.startswith((b"<?xml", b"<")):
        return "an XML document, not a photograph"
    if start.startswith(b"version https://git-lfs"):
        return "a pointer of Git LFS and not the file itself; fetch it with git lfs pull"
    return None


def _brands(data: bytes) -> list[bytes]:
    """Brands of a file of ISO base media, the major one first; none of other files."""
    if data[4:8] != b"ftyp":
        return []
    end = min(int.from_bytes(data[:4], "big"), 256)
    return [data[8:12], *(data[at : at + 4] for at in range(16, end - 3, 4))]
