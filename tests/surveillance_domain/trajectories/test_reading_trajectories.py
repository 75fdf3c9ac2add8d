"""The forms that people have trajectories in, what is wrong with a file, and the shared recordings."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from surveillance_domain.trajectories.conventions import Conventions, on_floor, read_homography, with_sidecar
from surveillance_domain.trajectories.formats import read_rows
from surveillance_domain.trajectories.load import load_tracks
from surveillance_domain.trajectories.rows import TrajectoryError

SHARED = Path(__file__).parents[3] / ".." / "shared" / "data" / "trajectories"

FRAME_TEXT = "780\t1.0\t8.46\t3.59\n790\t1.0\t9.57\t3.79\n780\t2\t1\t2\n790\t2\t1.5\t2\n"
OBSMAT = "780 1 8 0 3 1.5 0 0\n786 1 8.6 0 3 1.5 0 0\n792 1 9.2 0 3 1.5 0 0\n"
NDJSON = (
    '{"scene": {"id": 0, "p": 7, "s": 10, "e": 30, "fps": 2.5, "tag": [1, []]}}\n'
    '{"track": {"f": 10, "p": 7, "x": 0.0, "y": 0.0}}\n'
    '{"track": {"f": 20, "p": 7, "x": 0.4, "y": 0.0}}\n'
    '{"track": {"f": 30, "p": 7, "x": 0.8, "y": 0.1}}\n'
)
CSV = "Person,pos_x,pos_y,time_s,note\nann,0,0,0.0,a\nann,0.5,0,0.5,b\nbob,1,1,0.5,c\nbob,1,2,1.5,d\n"


def written(folder: Path, text: str, name: str = "people.txt") -> Path:
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return path


def shared(name: str) -> Path:
    path = SHARED / name
    if not path.is_file():
        pytest.skip(f"no shared recording {name}")
    return path


@pytest.mark.example
def test_four_columns(tmp_path: Path) -> None:
    rows = read_rows(written(tmp_path, FRAME_TEXT))
    assert rows.names == ("1", "2")  # 1.0 is the person 1
    assert rows.frames.tolist() == [780, 790, 780, 790]
    assert rows.points[1].tolist() == [9.57, 3.79]
    assert rows.lines.tolist() == [1, 2, 3, 4]


@pytest.mark.example
def test_obsmat_leaves_the_height_out_and_tells_velocities(tmp_path: Path) -> None:
    rows = read_rows(written(tmp_path, OBSMAT))
    assert rows.points.tolist() == [[8, 3], [8.6, 3], [9.2, 3]]
    assert rows.velocities is not None
    assert rows.velocities.tolist() == [[1.5, 0]] * 3


@pytest.mark.example
def test_fps_of_trajnet_counts_rows(tmp_path: Path) -> None:
    tracks = load_tracks(written(tmp_path, NDJSON))
    assert tracks.frame_s == pytest.approx(0.4)  # 2.5 rows a second, although frames count by tens
    assert tracks.tracks[0].times_s.tolist() == pytest.approx([0.4, 0.8, 1.2])


@pytest.mark.example
def test_csv_with_times_and_other_names(tmp_path: Path) -> None:
    columns = {"id": "person", "x": "pos_x", "y": "pos_y"}
    tracks = load_tracks(written(tmp_path, CSV), Conventions(columns=columns)).tracks
    assert [track.name for track in tracks] == ["ann", "bob"]
    assert tracks[1].times_s.tolist() == [0.5, 1.5]
    assert tracks[1].points_m.tolist() == [[1, 1], [1, 2]]


@pytest.mark.example
@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("", "an empty file"),
        ("1 2 3\n", "line 1: found 3 numbers; expected four columns"),
        ("1 1 0 0\n2 1 nan 0\n3 1 0\n", "line 2: found x = 'nan'"),
        ("1 1 0 0\n2 1 nan 0\n3 1 0\n", "line 3: found 3 columns; expected 4 numbers: frame, id, x, y"),
        ("% comment\n", "line 1: found '% comment'"),
        ("frame,id,x\n1,2,3\n", "line 1: found no column y among frame, id, x"),
        ("frame,id,x,y\n1,2,3,here\n", "line 2: found y = 'here'"),
        ('{"track": {"f": 1, "p": 2, "x": 3}}\n', "line 1: found"),
        ('{"track"\n', "line 1: found text that is not JSON"),
        (NDJSON + '{"scene": {"id": 1, "fps": 3}}\n', "line 5: found fps 3, after 2.5 on line 1"),
        ("5 1 0 0\n5 2 0 0\n", "no track of two points"),
    ],
)
def test_what_is_wrong_is_told_with_file_and_line(tmp_path: Path, text: str, told: str) -> None:
    path = written(tmp_path, text)
    with pytest.raises(TrajectoryError) as caught:
        load_tracks(path, Conventions(10.0))
    assert told in str(caught.value)
    assert str(caught.value).startswith(str(path))


@pytest.mark.example
def test_many_faults_are_cut_short(tmp_path: Path) -> None:
    with pytest.raises(TrajectoryError, match="15 more faults"):
        read_rows(written(tmp_path, "1 1 0 0\n" + "x 1 0 0\n" * 25))


@pytest.mark.example
def test_a_rate_is_never_guessed(tmp_path: Path) -> None:
    with pytest.raises(TrajectoryError, match=r"--frames-per-s F.*velocities speak of about 15"):
        load_tracks(written(tmp_path, OBSMAT))


@pytest.mark.example
def test_a_wrong_rate_is_told_by_the_files_own_velocities(tmp_path: Path) -> None:
    path = written(tmp_path, OBSMAT)
    assert load_tracks(path, Conventions(15.0)).warnings == ()
    (first, second) = load_tracks(path, Conventions(25.0)).warnings
    assert "speak of 15 frames a second; 25 is used" in first
    assert "2.5 m/s, which is not a walk" in second


@pytest.mark.example
def test_a_sidecar_says_what_options_leave_open(tmp_path: Path) -> None:
    path = written(tmp_path, "0 1 0 0\n10 1 100 0\n")
    written(tmp_path, "frames_per_s = 25\nmetres_per_unit = 0.005\n", "people.txt.toml")
    (track,) = load_tracks(path).tracks
    assert track.times_s.tolist() == pytest.approx([0, 0.4])
    assert track.points_m[1].tolist() == pytest.approx([0.5, 0])
    (track,) = load_tracks(path, Conventions(metres_per_unit=0.01)).tracks
    assert track.points_m[1].tolist() == pytest.approx([1, 0])


@pytest.mark.example
def test_a_sidecar_names_its_homography_and_its_faults(tmp_path: Path) -> None:
    path = written(tmp_path, FRAME_TEXT)
    written(tmp_path, "0 2 1\n2 0 0\n0 0 1\n", "H.txt")
    sidecar = written(tmp_path, 'homography = "H.txt"\n', "people.txt.toml")
    found = with_sidecar(path, Conventions())
    assert on_floor(np.array([[3.0, 4.0]]), found).tolist() == [[9, 6]]
    sidecar.write_text("frames_per_s = -1\nframe_rate = 3\n")
    with pytest.raises(TrajectoryError) as caught:
        with_sidecar(path, Conventions())
    assert "frames_per_s: found -1; expected frames a second, above 0" in str(caught.value)
    assert "did you mean frames_per_s?" in str(caught.value)


@pytest.mark.example
@pytest.mark.parametrize("text", ["1 0 0 0 1 0 0 0", "1 0 0 0 1 0 0 0 x", "1 2 3 2 4 6 0 0 1"])
def test_homographies_are_checked(tmp_path: Path, text: str) -> None:
    with pytest.raises(TrajectoryError, match=r"H.txt: (homography: )?found"):
        read_homography(written(tmp_path, text, "H.txt"))


@pytest.mark.example
def test_a_homography_divides_by_the_third_coordinate() -> None:
    matrix = np.array([[1.0, 0, 0], [0, 1, 0], [0, 0.5, 1]])
    points = on_floor(np.array([[4.0, 2.0], [1.0, -2.0]]), Conventions(homography=matrix))
    assert points[0].tolist() == [2, 1]
    assert np.isnan(points[1]).all()  # on the horizon


@pytest.mark.example
@pytest.mark.parametrize(
    ("name", "rate", "people", "frame_s", "walk_mps"),
    [
        ("ewap_seq_eth/obsmat.txt", 15.0, 360, 0.4, 1.47),
        ("ucy_zara01/obsmat.txt", 25.0, 148, 0.4, 1.19),
        ("sgan4col/biwi_eth.txt", 15.0, 360, 2 / 3, 1.47),
        ("sgan4col/crowds_zara01.txt", 25.0, 148, 0.4, 1.15),
        ("trajnetpp/crowds_zara01.ndjson", None, 148, 0.4, 1.15),
        ("trajnetpp/lcas.ndjson", None, 290, 0.4, 0.08),
    ],
)
def test_the_shared_recordings_load(
    name: str, rate: float | None, people: int, frame_s: float, walk_mps: float
) -> None:
    tracks = load_tracks(shared(name), Conventions(rate))
    assert len(tracks.people) == people
    assert tracks.frame_s == pytest.approx(frame_s)
    assert tracks.warnings == ()
    speeds = [np.hypot(*np.diff(t.points_m, axis=0).T) / np.diff(t.times_s) for t in tracks.tracks]
    assert np.median(np.concatenate(speeds)) == pytest.approx(walk_mps, abs=0.03)  # as the recordings' notes say


@pytest.mark.example
def test_the_resampled_form_of_eth_at_the_wrong_rate_is_noticed() -> None:
    (warning,) = load_tracks(shared("sgan4col/biwi_eth.txt"), Conventions(25.0)).warnings
    assert "not a walk" in warning


@pytest.mark.example
def test_pixels_go_through_the_homography_of_the_scene() -> None:
    """The image's centre of UCY's zara01 lies where its matrix says: last column over last entry."""
    matrix = read_homography(shared("ucy_zara01/H.txt"))
    (origin,) = on_floor(np.zeros((1, 2)), Conventions(homography=matrix)).tolist()
    assert origin == pytest.approx([7.838868, 5.566046], abs=1e-6)


PAGE = Path(__file__).parents[3] / "docs" / "formats" / "recordings.md"


@pytest.mark.example
def test_the_forms_of_the_page_are_read(tmp_path: Path) -> None:
    """Each example of the page, as it stands there, with a sidecar where the page says that one is needed."""
    four, obsmat, trajnet, csv = (part.partition("```")[0] for part in PAGE.read_text().split("```text\n")[1:])
    for name, text in (("four.txt", four), ("obsmat.txt", obsmat), ("people.ndjson", trajnet), ("people.csv", csv)):
        written(tmp_path, text, name)
    sidecar = PAGE.read_text().split("```toml\n")[1].partition("```")[0]
    written(tmp_path, sidecar, "four.txt.toml")
    written(tmp_path, "1 0 0\n0 1 0\n0 0 1\n", "H.txt")
    written(tmp_path, 'columns = { id = "person", x = "pos_x", y = "pos_y" }\n', "people.csv.toml")
    assert load_tracks(tmp_path / "four.txt").frame_s == pytest.approx(10 / 15)
    assert load_tracks(tmp_path / "obsmat.txt", Conventions(15.0)).warnings == ()
    assert load_tracks(tmp_path / "people.ndjson").frame_s == pytest.approx(0.4)
    assert load_tracks(tmp_path / "people.csv").people == ("ann",)


@pytest.mark.example
def test_without_a_rate_the_sidecar_is_named(tmp_path: Path) -> None:
    path = written(tmp_path, FRAME_TEXT)
    with pytest.raises(TrajectoryError, match=r"frames_per_s = F in a file .*people\.txt\.toml"):
        load_tracks(path)


@pytest.mark.example
def test_a_rate_forced_onto_a_file_that_has_its_own_names_the_way_out(tmp_path: Path) -> None:
    (warning,) = load_tracks(written(tmp_path, NDJSON), Conventions(15.0)).warnings
    assert "the file itself says 25 frames a second; 15 was given" in warning
    assert "leave --frames-per-s out" in warning
    assert "frames_per_s = 15" in warning


@pytest.mark.example
def test_large_ids_are_not_rounded_together(tmp_path: Path) -> None:
    rows = read_rows(written(tmp_path, "0 1600000000000000001 0 0\n0 1600000000000000003 1 1\n"))
    assert rows.names == ("1600000000000000001", "1600000000000000003")


@pytest.mark.property
@pytest.mark.parametrize("separator", [" ", ","])
def test_many_lines_at_once_are_read_as_one_by_one(tmp_path: Path, separator: str) -> None:
    """A name that is no number sends its block through the slow way; the numbers must be the same."""
    rng = np.random.default_rng(0)
    numbers = rng.normal(size=(300, 2)).round(3)
    lines = [f"{n // 3} {n % 3} {x} {y}".replace(" ", separator) for n, (x, y) in enumerate(numbers.tolist())]
    for header in ([], ["frame,id,x,y"] if separator == "," else []):
        fast = read_rows(written(tmp_path, "\n".join([*header, *lines])))
        named = [*header, *lines, f"0{separator}ann{separator}0{separator}0"]
        slow = read_rows(written(tmp_path, "\n".join(named)))
        assert slow.names == (*fast.names, "ann")
        assert slow.frames[:-1].tolist() == fast.frames.tolist()
        assert slow.tracks[:-1].tolist() == fast.tracks.tolist()
        assert slow.points[:-1].tolist() == fast.points.tolist()
        assert slow.lines[:-1].tolist() == fast.lines.tolist()


@pytest.mark.example
def test_a_file_of_several_blocks_keeps_its_line_numbers(tmp_path: Path) -> None:
    lines = [
        f"{n} {n % 7} {n / 8} 0.{'0' * 60}" for n in range(50_000)
    ]  # more than one block of two million characters
    told = []
    path = written(tmp_path, "\n".join(lines))
    rows = read_rows(path, advance=told.append)
    assert len(told) > 1
    assert sum(told) == path.stat().st_size
    assert rows.lines.tolist() == list(range(1, 50_001))
    assert rows.names == tuple("0123456")
    lines[40_000] = "here"
    with pytest.raises(TrajectoryError, match="line 40001: found 1 columns"):
        read_rows(written(tmp_path, "\n".join(lines)))


@pytest.mark.example
def test_quoted_words_may_go_over_lines(tmp_path: Path) -> None:
    text = 'frame,id,x,y,note\n0,"ann",0,0,"by\nthe door"\n1,ann,1,0,\n2,ann,here,0,\n'
    with pytest.raises(TrajectoryError, match="line 5: found x = 'here'"):
        read_rows(written(tmp_path, text))
    rows = read_rows(written(tmp_path, text.replace("here", "2")))
    assert rows.points.tolist() == [[0, 0], [1, 0], [2, 0]]
