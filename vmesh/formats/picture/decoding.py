"""Files -> decoded pictures: each format by whoever reads it right."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from PIL import Image

from vmesh.arrays import SampleArray
from vmesh.errors import ImageError, LimitError
from vmesh.formats.picture import truncation
from vmesh.formats.picture.adam7 import fill_blocks
from vmesh.formats.picture.depths import rounding_note
from vmesh.formats.picture.jpeg2000 import depth_of_jpeg2000, read_jpeg2000
from vmesh.formats.picture.modes import array_of
from vmesh.formats.picture.opening import DamagedError, check_size, open_image
from vmesh.formats.picture.options import PictureOptions
from vmesh.formats.picture.pages import choose_largest, go_to_frame, uncovered
from vmesh.formats.picture.png import Png, is_png, read_png
from vmesh.formats.picture.samples import as_rgba, with_key
from vmesh.formats.picture.tiff import carrier_of, is_tiff, read_pages, read_samples
from vmesh.limits import Limits


@dataclass(frozen=True, slots=True)
class Decoded:
    """A picture as its file has it, not yet turned upright.

    Parameters
    ----------
    image : Image
        With its metadata, and with its pixels unless there are `samples`.
    samples : ndarray, optional
        uint8 or uint16, shape (h, w), (h, w, 3) or (h, w, 4).
    is_upright : bool
        True if its decoder has turned it, whatever its metadata say.
    notes : tuple of str
        For the user, about what was left out or had to be guessed.
    """

    image: Image.Image
    samples: SampleArray | None = None
    is_upright: bool = False
    notes: tuple[str, ...] = ()


def decode(data: bytes, options: PictureOptions, limits: Limits) -> Decoded:
    """The picture in a file.

    Raises
    ------
    ImageError, LimitError
    """
    if is_png(data):
        return _decode_png(data, options, limits)
    if is_tiff(data):
        return _decode_tiff(data, options, limits)
    if depth_of_jpeg2000(data) > 8:
        return _decode_jpeg2000(data, limits)
    return _decode_by_pillow(data, options, limits)


def _decode_png(data: bytes, options: PictureOptions, limits: Limits) -> Decoded:
    png = read_png(data, limits)
    check_size(png.header[:2], limits)
    notes = png.notes
    try:
        samples, more = _pixels_of_png(png, options, limits)
        notes += more
    except (ImageError, LimitError, MemoryError):
        raise
    except Exception as error:
        # Decoders of damaged images raise errors of many kinds.
        counts, share = png.count_rows()
        if share < 1 and png.is_whole and not options.allow_truncated:
            raise ImageError(f"the image is damaged: {error}") from None
        if share == 0 or (share < 1 and not options.allow_truncated):
            raise ImageError(truncation.refusal(share)) from None
        samples, _ = _pixels_of_png(png.mended(counts), PictureOptions(), limits)
        if png.header.interlacing:
            samples = fill_blocks(samples, counts)
        notes += (truncation.note(share),) if share < 1 else ()
    carrier = open_image(png.carrier(), limits)
    carrier.load()
    carrier.info.update({"icc_profile": png.icc, "xmp": png.xmp})
    return Decoded(carrier, samples, notes=notes)


def _pixels_of_png(
    png: Png, options: PictureOptions, limits: Limits
) -> tuple[SampleArray, tuple[str, ...]]:
    """Samples of a PNG, with notes about its frames."""
    image, notes = go_to_frame(open_image(png.to_bytes(), limits), options.page)
    if png.is_deep and image.tell() == 0:
        samples = png.samples()
        samples = as_rgba(samples) if samples.shape[2] == 2 else samples
    else:
        image.load()
        samples, _ = array_of(image)
    if png.key is not None:
        samples = with_key(samples, png.key, png.header.depth)
    return samples, notes


def _decode_tiff(data: bytes, options: PictureOptions, limits: Limits) -> Decoded:
    pages = read_pages(data)
    index, notes = choose_largest(
        [page.size for page in pages], [page.is_secondary for page in pages], options.page
    )
    page = pages[index]
    check_size(page.size, limits)
    if not page.needs_samples and not page.is_cut:
        try:
            image = open_image(data, limits)
            image.seek(page.index)
        except (ImageError, EOFError, SyntaxError, ValueError):
            pass  # of a mode that Pillow lacks
        else:
            # A copy, which has the metadata that it is given and none of its own.
            copy = _loaded(image).copy()
            copy.info.update(carrier_of(data, page.index).info)
            return Decoded(copy, is_upright=True, notes=notes)
    samples, more, share = read_samples(data, page.index, limits, allow_missing=page.is_cut)
    if page.is_cut:
        if share == 0 or (share < 1 and not options.allow_truncated):
            raise ImageError(truncation.refusal(share))
        more += (truncation.note(share),)
    return Decoded(carrier_of(data, page.index), samples, notes=notes + more)


def _decode_jpeg2000(data: bytes, limits: Limits) -> Decoded:
    image = open_image(data, limits)
    check_size(image.size, limits)
    try:
        samples, notes = read_jpeg2000(data)
    except (ImageError, MemoryError):
        raise
    except Exception as error:
        raise ImageError(_fault(data, error)) from None
    carrier = Image.new("L", (1, 1))
    carrier.info = dict(image.info)
    return Decoded(carrier, samples, notes=notes)


def _decode_by_pillow(data: bytes, options: PictureOptions, limits: Limits) -> Decoded:
    notes: tuple[str, ...] = ()

    def load(content: bytes) -> Image.Image:
        nonlocal notes
        image = open_image(content, limits)
        check_size(image.size, limits)
        image, notes = go_to_frame(image, options.page)
        check_size(image.size, limits)
        return _on_canvas(image) if image.format == "GIF" else _loaded(image)

    try:
        image = load(data)
    except (LimitError, MemoryError):
        raise
    except Exception as error:
        # Decoders of damaged images raise errors of many kinds.
        if isinstance(error, ImageError) and not isinstance(error, DamagedError):
            raise
        part = None if truncation.is_cut_in_boxes(data) else truncation.read_partly(data, load)
        if part is None or part.share == 0:
            raise ImageError(_fault(data, error)) from None
        is_complete = part.share == 1 and not part.is_coarse
        if not is_complete and not options.allow_truncated:
            raise ImageError(truncation.refusal(part.share, is_coarse=part.is_coarse)) from None
        image = part.image
        notes += (truncation.note(part.share, is_coarse=part.is_coarse),)
    # What JPEG XL keeps of a JPEG lies as in the JPEG, all else as it is to be shown.
    is_upright = image.format in ("HEIF", "JXL") and not getattr(image, "jpeg", False)
    return Decoded(image, is_upright=is_upright, notes=notes + rounding_note(data, image))


def _loaded(image: Image.Image) -> Image.Image:
    image.load()
    return image


def _on_canvas(image: Image.Image) -> Image.Image:
    """A frame of a GIF, transparent where nothing was painted."""
    outside = uncovered(image)
    if outside is None:
        return image
    pixels = np.array(image.convert("RGBA"))
    pixels[outside] = 0
    canvas = Image.fromarray(pixels)
    canvas.info = {name: value for name, value in image.info.items() if name != "transparency"}
    return canvas


def _fault(data: bytes, error: Exception) -> str:
    """Words about a file of which nothing can be read."""
    if truncation.is_cut_in_boxes(data):
        return "the file is cut off, and pictures of its format can only be read whole"
    if truncation.is_cut_in_riff(data) or truncation.ends_early(error):
        return truncation.NOTHING
    return str(error) if isinstance(error, DamagedError) else f"the image is damaged: {error}"
