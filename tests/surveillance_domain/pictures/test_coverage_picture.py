"""The coverage picture: what it shows, and that its files are whole, equal from run to run, and alone."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from PIL import Image

from surveillance_domain.model.views import Views, build_views
from surveillance_domain.pictures.coverage import draw_coverage
from surveillance_domain.pictures.floor import draw_cells
from surveillance_domain.pictures.style import CAMERA_COLOURS, new_figure, save_figure
from surveillance_domain.site.grid import Grid
from surveillance_domain.site.load import load_site

EXAMPLE = Path(__file__).parents[3] / "examples" / "office" / "office.toml"


@pytest.mark.example
@pytest.mark.parametrize("name", ["hall", "corridor", "junction", "lego", "tiny", "tiny-3", "micro", EXAMPLE])
def test_there_is_a_panel_for_every_preset_and_one_for_the_best_of_them(name: str | Path) -> None:
    site = load_site(name)
    figure = draw_coverage(site, build_views(site))
    assert len(figure.axes) == 1 + sum(len(camera.presets) for camera in site.cameras)
    titles = [axes.get_title().replace("\n", " ") for axes in figure.axes[1:]]
    presets = [f"{camera.name}: {preset.name}" for camera in site.cameras for preset in camera.presets]
    assert [title.rpartition(" (")[0] for title in titles] == presets


@pytest.mark.example
def test_the_title_states_the_shares() -> None:
    site = load_site("tiny")
    figure = draw_coverage(site, build_views(site))
    assert figure.get_suptitle() == "tiny: the best joint preset sees 50% of the floor, all presets see 70%"
    ones = Views((np.ones((3, 20)), np.ones((3, 20))), (0.0, 0.0))
    assert "sees 100% of the floor, all presets see 100%" in draw_coverage(site, ones).get_suptitle()


@pytest.mark.example
def test_the_outline_of_an_area_is_its_rim() -> None:
    grid = Grid.from_rows(["...", "..."], 0.5, (1.0, 2.0))
    axes = new_figure(2.0, 2.0).add_subplot()
    draw_cells(axes, grid, np.array([True, True, False, False, False, False]), CAMERA_COLOURS[0])
    (lines,) = (child for child in axes.collections if isinstance(child, LineCollection))
    edges = {tuple(map(tuple, segment.tolist())) for segment in lines.get_segments()}
    assert edges == {
        ((1.0, 2.0), (1.0, 2.5)),
        ((2.0, 2.0), (2.0, 2.5)),
        ((1.0, 2.0), (1.5, 2.0)),
        ((1.5, 2.0), (2.0, 2.0)),
        ((1.0, 2.5), (1.5, 2.5)),
        ((1.5, 2.5), (2.0, 2.5)),
    }


@pytest.mark.end_to_end
def test_png_and_svg_are_written_whole_and_the_same_again(tmp_path: Path) -> None:
    site = load_site("micro")
    views = build_views(site)
    first = save_figure(draw_coverage(site, views), tmp_path / "new folder" / "one.png")
    second = save_figure(draw_coverage(site, views), tmp_path / "two.svg")
    assert [path.name for path in (*first, *second)] == ["one.png", "one.svg", "two.png", "two.svg"]
    assert first[1].read_bytes() == second[1].read_bytes()
    assert first[0].read_bytes() == second[0].read_bytes()
    assert b"</svg>" in first[1].read_bytes()
    with Image.open(first[0]) as picture:
        assert picture.width == 1500
    assert sorted(path.name for path in first[0].parent.iterdir()) == ["one.png", "one.svg"]


@pytest.mark.end_to_end
def test_a_failure_leaves_the_old_file_and_nothing_half_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "one.png").write_bytes(b"old")

    def fail(self: Figure, file: object, **options: object) -> None:
        file.write(b"half")  # type: ignore[attr-defined]
        raise OSError("disk full")

    monkeypatch.setattr(Figure, "savefig", fail)
    with pytest.raises(OSError, match="disk full"):
        save_figure(new_figure(1.0, 1.0), tmp_path / "one.png")
    assert [(path.name, path.read_bytes()) for path in tmp_path.iterdir()] == [("one.png", b"old")]


@pytest.mark.end_to_end
def test_sites_and_views_load_without_matplotlib() -> None:
    code = (
        "import sys; from surveillance_domain.site.load import load_site; "
        "from surveillance_domain.model.views import build_views; import surveillance_domain.pictures.coverage; "
        "load_site('hall'); print(sorted({'matplotlib', 'PIL', 'yaml', 'numba', 'scipy'} & set(sys.modules)))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
