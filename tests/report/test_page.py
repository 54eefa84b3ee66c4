"""What is in a report, without a browser."""

from __future__ import annotations

import base64
import io
import re
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from lxml import html
from PIL import Image

import vmesh
from tests.pictures import PICTURES
from tests.report.studies import study_of
from vmesh.arrays import UInt8Array
from vmesh.report.page import page_of, section_of
from vmesh.report.rivals import Curve
from vmesh.report.study import Study

MARKUP = "<script>alert(1)</script> & \"two\" 'quotes'"


@pytest.fixture(scope="module")
def found(coffee: UInt8Array) -> Study:
    return study_of(np.ascontiguousarray(coffee[100:180, 200:320]), vertices=300)


def page_with(*studies: Study) -> Any:
    """The tree of a page, as a browser would read it."""
    return html.fromstring(page_of(section_of(study, i) for i, study in enumerate(studies)))


def table_of(page: Any, caption: str) -> dict[str, list[str]]:
    """Cells of each row of a table by the name of the row; the head is a row too."""
    (table,) = page.xpath(f"//table[caption[starts-with(., '{caption}')]]")
    rows = ([cell.text_content() for cell in row] for row in table.iter("tr"))
    return {name: cells for name, *cells in rows}


def picture_in(page: Any) -> UInt8Array:
    """The photograph in a page."""
    data = page.xpath("//img/@src")[0].removeprefix("data:image/png;base64,")
    return np.asarray(Image.open(io.BytesIO(base64.b64decode(data))))


def test_a_page_holds_the_photograph_and_the_file(found: Study) -> None:
    page = page_with(found)
    assert np.array_equal(picture_in(page), found.original)
    (data,) = page.xpath("//section/script/text()")
    assert base64.b64decode(data) == found.data
    assert vmesh.loads(base64.b64decode(data)) == found.mesh


def test_figures_are_told(found: Study) -> None:
    page = page_with(found)
    summary = page.xpath("//section/p")[0].text_content()
    assert f"{found.closeness['psnr_rgb']:.2f} dB" in summary
    assert f"{found.closeness['ssim']:.4f}" in summary
    assert "120 × 80 pixels" in summary
    assert list(table_of(page, "Time")) == ["stage", "encode", "write", "read", "render"]


def test_parts_in_the_table_add_up_to_the_file(found: Study) -> None:
    parts = table_of(page_with(found), "Bytes by part")
    del parts["part"]
    (whole, _), *_ = [parts.pop("file")]
    assert int(whole.replace(",", "")) == len(found.data)
    assert sum(int(n_bytes.replace(",", "")) for n_bytes, _ in parts.values()) == len(found.data)


def test_the_table_has_a_column_for_each_curve(found: Study) -> None:
    rows = table_of(page_with(found), "PSNR")
    assert rows.pop("bytes") == [curve.codec for curve in found.curves if curve.points]
    for (budget, decibels), (name, cells) in zip(found.curves[0].points, rows.items(), strict=True):
        assert (name, cells[0]) == (f"{budget:,}", f"{decibels:.2f}")
    assert any(f"{found.curves[1].points[-1].psnr:.2f}" in cells for cells in rows.values())


def test_equal_pictures_have_no_finite_psnr() -> None:
    page = page_with(study_of(PICTURES["constant"]))
    assert "PSNR ∞ dB" in page.text_content()
    assert all(cells[0] == "∞" for name, cells in table_of(page, "PSNR").items() if name != "bytes")


def test_a_codec_without_files_is_named_with_the_reason(found: Study) -> None:
    absent = Curve("AVIF", (), "cannot be written by this Pillow")
    page = page_with(replace(found, curves=(*found.curves[:3], absent)))
    (caption,) = page.xpath("//figcaption")
    assert caption.text_content() == "AVIF is left out: it cannot be written by this Pillow."
    assert "AVIF" not in table_of(page, "PSNR")["bytes"]


def test_the_plot_names_the_codecs_that_have_files(found: Study) -> None:
    plot = page_with(found).xpath("//figure//svg")[0].text_content()
    for name in ("vmesh", "JPEG", "bytes of the file", "PSNR over RGB, dB"):
        assert name in plot


def test_plots_of_a_page_share_no_names(found: Study) -> None:
    names = page_with(found, found).xpath("//@id")
    assert names
    assert len(names) == len(set(names))


def test_names_and_metadata_are_text(found: Study) -> None:
    plain = page_with(found)
    exif = Image.Exif()
    exif[270] = exif[315] = "<b>&amp;"
    mesh = found.mesh.replaced(metadata=vmesh.Metadata(exif=exif.tobytes()))
    page = page_with(replace(found, name=MARKUP, mesh=mesh))
    assert page.xpath("//h2")[0].text_content() == MARKUP
    assert page.xpath("//img/@alt") == [f"Photograph: {MARKUP}"]
    assert page.xpath("//canvas/@aria-label") == [f"Mesh: {MARKUP}"]
    assert page.xpath("//section/p")[0].text_content().startswith("<b>&amp;, <b>&amp;. 120 × 80")
    assert [e.tag for e in page.iter()] == [e.tag for e in plain.iter()]


def test_a_name_that_is_no_text_is_shown_as_far_as_it_is(found: Study) -> None:
    assert page_with(replace(found, name="caf\udce9.png")).xpath("//h2")[0].text == "caf?.png"


def test_a_large_photograph_is_reduced(found: Study) -> None:
    large = np.zeros((1500, 6000, 3), dtype=np.uint8)
    page = page_with(replace(found, original=large))
    height, width, _ = picture_in(page).shape
    assert width * height == pytest.approx(1 << 22, rel=1e-3)
    assert width / height == pytest.approx(4, rel=1e-3)
    assert page.xpath("//canvas/@width") == [str(width)]


def test_a_page_refers_to_nothing_outside(found: Study) -> None:
    page = page_with(found)
    (policy,) = page.xpath("//meta[@http-equiv='Content-Security-Policy']/@content")
    assert "default-src 'none'" in policy
    assert not page.xpath("//link | //iframe | //object | //script[@src]")
    references = page.xpath("//@src | //@href | //@*[name() = 'xlink:href']")
    assert all(re.match("data:image/png|#", reference) for reference in references)


def test_the_same_study_gives_the_same_page(found: Study) -> None:
    assert section_of(found, 0) == section_of(found, 0)


def test_settings_of_matplotlib_do_not_reach_the_page(found: Study) -> None:
    import matplotlib as mpl

    plain = section_of(found, 0)
    with mpl.rc_context({"axes.facecolor": "red", "font.size": 30, "svg.fonttype": "path"}):
        assert section_of(found, 0) == plain
