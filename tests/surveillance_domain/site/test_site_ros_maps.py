"""Maps of ROS map_server: pixel values, modes, resampling, real maps, damaged files."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays
from PIL import Image

from surveillance_domain.site.faults import SiteError
from surveillance_domain.site.load import load_site
from surveillance_domain.site.ros_maps import RosMap, RosMapError, read_ros_map

MAPS = Path(__file__).parents[3] / ".." / "shared" / "data" / "maps" / "ros"
EXAMPLE = Path(__file__).parents[3] / "examples" / "office" / "office.toml"
YAML = """image: map.pgm
resolution: 0.5
origin: [-1.0, 2.0, 0.0]
negate: 0
occupied_thresh: 0.65
free_thresh: 0.25
"""


def pair(folder: Path, picture: np.ndarray | bytes, yaml: str = YAML, name: str = "map.pgm") -> Path:
    """A yaml file beside its picture (bytes as they are, an array by the ending of its name)."""
    if isinstance(picture, bytes):
        (folder / name).write_bytes(picture)
    else:
        Image.fromarray(picture).save(folder / name)
    file = folder / "map.yaml"
    file.write_text(yaml.replace("map.pgm", name), encoding="utf-8")
    return file


def states(ros_map: RosMap) -> list[list[str]]:
    """``#`` occupied, ``.`` free, ``?`` unknown; top row first, as the picture."""
    marks = np.where(ros_map.occupied, "#", np.where(ros_map.free, ".", "?"))
    return [list(row) for row in marks[::-1]]


def told(file: Path) -> list[tuple[str, str]]:
    with pytest.raises(RosMapError) as caught:
        read_ros_map(file)
    return [(fault.where, f"{fault.found} | {fault.expected}") for fault in caught.value.faults]


# p = (255 - v) / 255: 254 -> 0.004, 205 -> 0.196, 192 -> 0.247, 191 -> 0.251, 90 -> 0.647, 89 -> 0.651, 0 -> 1
GREYS = np.array([[254, 205, 192], [191, 90, 89]], dtype=np.uint8)


@pytest.mark.example
def test_trinary_thresholds(tmp_path: Path) -> None:
    ros_map = read_ros_map(pair(tmp_path, GREYS))
    assert states(ros_map) == [[".", ".", "."], ["?", "?", "#"]]
    assert (ros_map.resolution_m, ros_map.origin_m) == (0.5, (-1.0, 2.0))


@pytest.mark.example
def test_the_top_row_of_the_picture_is_the_top_of_the_map(tmp_path: Path) -> None:
    grid = read_ros_map(pair(tmp_path, np.array([[0, 0], [254, 254]], dtype=np.uint8))).grid(0.5)
    assert grid.free.tolist() == [[True, True], [False, False]]
    assert grid.centres_m.tolist() == [[-0.75, 2.25], [-0.25, 2.25]]


@pytest.mark.example
def test_negate_swaps_dark_and_light(tmp_path: Path) -> None:
    ros_map = read_ros_map(pair(tmp_path, 255 - GREYS, YAML.replace("negate: 0", "negate: 1")))
    assert states(ros_map) == [[".", ".", "."], ["?", "?", "#"]]


@pytest.mark.example
def test_plain_and_binary_pgm_are_the_same(tmp_path: Path) -> None:
    plain = b"P2\n# a comment\n3 2\n255\n254 205 192\n191 90 89\n"
    assert states(read_ros_map(pair(tmp_path, plain))) == [[".", ".", "."], ["?", "?", "#"]]
    assert states(read_ros_map(pair(tmp_path, b"P5\n3 2\n255\n" + GREYS.tobytes())))[1] == ["?", "?", "#"]


@pytest.mark.example
def test_other_depths_of_grey_are_scaled_to_eight_bits(tmp_path: Path) -> None:
    assert states(read_ros_map(pair(tmp_path, b"P2\n3 1\n15\n15 7 0\n"))) == [[".", "?", "#"]]
    assert states(read_ros_map(pair(tmp_path, b"P2\n3 1\n65535\n65535 30000 0\n"))) == [[".", "?", "#"]]
    deep = np.array([[65535, 30000, 0]], dtype=np.uint16)
    assert states(read_ros_map(pair(tmp_path, deep, name="map.png"))) == [[".", "?", "#"]]


@pytest.mark.example
def test_colours_are_averaged(tmp_path: Path) -> None:
    colours = np.array([[[255, 255, 255], [255, 255, 0], [255, 0, 0]]], dtype=np.uint8)  # p = 0, 1/3, 2/3
    assert states(read_ros_map(pair(tmp_path, colours, name="map.png"))) == [[".", "?", "#"]]


@pytest.mark.example
def test_alpha_counts_as_a_colour_in_trinary_mode_and_as_unknown_in_scale_mode(tmp_path: Path) -> None:
    # white opaque, white transparent ((3 * 255 + 0) / 4 -> p = 0.25, not below 0.25), black transparent, black opaque
    pixels = np.array([[[255, 255, 255, 255], [255, 255, 255, 0], [0, 0, 0, 0], [0, 0, 0, 255]]], dtype=np.uint8)
    # black opaque: (0 + 255) / 4 -> p = 0.75, still occupied
    assert states(read_ros_map(pair(tmp_path, pixels, name="map.png"))) == [[".", "?", "#", "#"]]
    scale = YAML + "mode: scale\n"
    assert states(read_ros_map(pair(tmp_path, pixels, scale, "map.png"))) == [[".", "?", "?", "#"]]


@pytest.mark.example
def test_scale_mode_leaves_the_values_between_unknown(tmp_path: Path) -> None:
    assert states(read_ros_map(pair(tmp_path, GREYS, YAML + "mode: scale\n"))) == [[".", ".", "."], ["?", "?", "#"]]


@pytest.mark.example
def test_raw_mode_reads_percent(tmp_path: Path) -> None:
    values = np.array([[0, 25, 26, 64], [65, 100, 101, 255]], dtype=np.uint8)
    ros_map = read_ros_map(pair(tmp_path, values, YAML + "mode: raw\n"))
    assert states(ros_map) == [[".", ".", "?", "?"], ["#", "#", "?", "?"]]


@pytest.mark.example
def test_a_cell_is_blocked_by_one_pixel_and_free_by_half_of_them() -> None:
    occupied = np.zeros((2, 8), dtype=bool)
    free = np.zeros((2, 8), dtype=bool)
    free[:, 0:2] = True  # cell 0: all free
    free[:, 2:4] = [[True, True], [True, False]]
    occupied[1, 3] = True  # cell 1: three free, one occupied
    free[0, 4:6] = True  # cell 2: two of four free
    free[0, 6] = True  # cell 3: one of four free
    ros_map = RosMap(occupied, free, 0.1, (0.0, 0.0))
    assert ros_map.grid(0.2).free.tolist() == [[True, False, True, False]]
    assert ros_map.grid(0.2, unknown="free").free.tolist() == [[True, False, True, True]]


@pytest.mark.example
def test_cells_smaller_than_pixels_and_cells_over_the_rim() -> None:
    ros_map = RosMap(np.array([[False, True]]), np.array([[True, False]]), 1.0, (0.0, 0.0))
    assert ros_map.grid(0.5).free.tolist() == [[True, True, False, False]] * 2
    assert ros_map.grid(3.0).free.tolist() == [[False]]
    with pytest.raises(RosMapError, match="20000000 are needed"):
        ros_map.grid(1e-4)


@pytest.mark.property
@given(
    occupancy=arrays.arrays(np.int8, st.tuples(st.integers(1, 9), st.integers(1, 9)), elements=st.integers(0, 2)),
    tenths=st.integers(3, 40),
    unknown=st.sampled_from(["blocked", "free"]),
)
def test_resampling_follows_the_rule_pixel_by_pixel(occupancy: np.ndarray, tenths: int, unknown: str) -> None:
    occupied, free = occupancy == 2, occupancy == 1
    grid = RosMap(occupied, free, 1.0, (0.0, 0.0)).grid(tenths / 10, unknown)
    for row in range(grid.rows):
        for column in range(grid.columns):
            inside = [
                (j, i)
                for j in range(occupied.shape[0])
                for i in range(occupied.shape[1])
                if (10 * j + 5) // tenths == row and (10 * i + 5) // tenths == column
            ]
            if not inside:  # the pixel under the cell's centre
                j, i = ((2 * at + 1) * tenths // 20 for at in (row, column))
                inside = [(min(j, occupied.shape[0] - 1), min(i, occupied.shape[1] - 1))]
            shares = [free[pixel] for pixel in inside]
            expected = not any(occupied[pixel] for pixel in inside) and (
                2 * sum(shares) >= len(shares) or unknown == "free"
            )
            assert grid.free[row, column] == expected


REAL = sorted(MAPS.glob("*.yaml"))
# Shares of free, occupied and unknown pixels as the folder's own list of contents states them.
SHARES = {
    "intel.yaml": (0.574, 0.089, 0.337),
    "simple_rooms.yaml": (0.693, 0.307, 0.000),
    "turtlebot3_map.yaml": (0.054, 0.005, 0.941),
    "willow-2010-02-18-0.10.yaml": (0.317, 0.002, 0.681),
}


@pytest.mark.example
@pytest.mark.parametrize("name", sorted(SHARES))
def test_real_maps_load(name: str) -> None:
    file = MAPS / name
    if not file.exists():
        pytest.skip("the shared ROS maps are not there")
    ros_map = read_ros_map(file)
    shares = (ros_map.free.mean(), ros_map.occupied.mean(), 1 - (ros_map.free | ros_map.occupied).mean())
    assert shares == pytest.approx(SHARES[name], abs=6e-4)
    assert ros_map.grid(0.5).size > 0


@pytest.mark.example
def test_every_real_map_whose_picture_is_there_is_in_the_list() -> None:
    if not REAL:
        pytest.skip("the shared ROS maps are not there")
    for file in REAL:
        assert file.name in SHARES or told(file)[0][1].startswith("no such file")


@pytest.mark.example
@pytest.mark.parametrize(
    ("change", "where", "message"),
    [
        (("resolution: 0.5", "resolution: 0"), "resolution", "metres per pixel above 0"),
        (("resolution: 0.5", "resolution: .nan"), "resolution", "metres per pixel above 0"),
        (("resolution: 0.5", ""), "resolution", "nothing"),
        (("image: map.pgm", "image: 3"), "image", "path"),
        (("[-1.0, 2.0, 0.0]", "[-1.0, 2.0]"), "origin", "[x, y, yaw]"),
        (("[-1.0, 2.0, 0.0]", "[-1.0, 2.0, 1.57]"), "origin", "yaw of 0"),
        (("[-1.0, 2.0, 0.0]", "[x, 2.0, 0]"), "origin[0]", "[x, y, yaw]"),
        (("negate: 0", "negate: 2"), "negate", "0 or 1"),
        (("occupied_thresh: 0.65", "occupied_thresh: 65"), "occupied_thresh", "0 to 1"),
        (("free_thresh: 0.25", "free_thresh: 0.7"), "free_thresh", "occupied_thresh"),
        (("negate: 0", "negate: 0\nmode: ternary"), "mode", "trinary"),
        (("negate: 0", "negate: [0"), "line 5", "YAML"),
    ],
)
def test_a_wrong_yaml_file_is_told_key_by_key(
    tmp_path: Path, change: tuple[str, str], where: str, message: str
) -> None:
    assert change[0] in YAML
    found = told(pair(tmp_path, GREYS, YAML.replace(*change)))
    assert [place for place, _ in found] == [where]
    assert message in found[0][1]


@pytest.mark.example
@pytest.mark.parametrize("text", ["", "just text", "- 1\n- 2\n", "\xff"])
def test_a_yaml_file_without_keys_is_refused(tmp_path: Path, text: str) -> None:
    file = tmp_path / "map.yaml"
    file.write_bytes(text.encode("latin-1"))
    assert len(told(file)) == 1


@pytest.mark.example
@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"P5\n3 2\n255\n\x00", "damaged"),
        (b"P5\n3", "damaged"),
        (b"P5\n-3 2\n255\n" + bytes(6), "damaged"),
        (b"P2\n3 2\n255\n1 2 x\n", "damaged"),
        (b"", "PGM (P2 or P5), PNG or BMP"),
        (b"GIF89a", "PGM (P2 or P5), PNG or BMP"),
        (b"P5\n100000 100000\n255\n", "at most 50 million pixels"),
        (b"P5\n10000 6000\n255\n", "at most 50 million pixels"),
    ],
)
def test_a_damaged_or_huge_picture_is_refused(tmp_path: Path, content: bytes, message: str) -> None:
    found = told(pair(tmp_path, content))
    assert len(found) == 1
    assert message in found[0][1]


@pytest.mark.example
def test_a_site_on_a_ros_map_names_the_file_that_is_missing(tmp_path: Path) -> None:
    text = EXAMPLE.read_text(encoding="utf-8")
    site = tmp_path / "site.toml"
    site.write_text(text.replace("office.yaml", "map.yaml"), encoding="utf-8")
    with pytest.raises(SiteError, match=r"map\.ros.*map\.yaml.*no such file"):
        load_site(site)
    pair(tmp_path, GREYS, YAML.replace("0.65", "65"))
    with pytest.raises(SiteError, match=r"map\.ros: found in .*map\.yaml, occupied_thresh: 65"):
        load_site(site)
    site.write_text(site.read_text().replace("cell_m = 0.5", "cell_m = 0.001"), encoding="utf-8")
    pair(tmp_path, np.full((60, 60), 254, dtype=np.uint8))
    with pytest.raises(SiteError, match=r"map\.cell_m: found 0\.001, which makes 900000000 cells"):
        load_site(site)
    (tmp_path / "map.pgm").unlink()
    with pytest.raises(SiteError, match=r"map\.ros.*map\.pgm.*no such file"):
        load_site(site)


@pytest.mark.example
def test_the_digest_follows_yaml_and_picture(tmp_path: Path) -> None:
    for name in ("office.toml", "office.yaml", "office.pgm"):
        (tmp_path / name).write_bytes((EXAMPLE.parent / name).read_bytes())
    digests = {load_site(tmp_path / "office.toml").digest}
    with (tmp_path / "office.yaml").open("a") as file:
        file.write("# \n")
    digests.add(load_site(tmp_path / "office.toml").digest)
    picture = bytearray((tmp_path / "office.pgm").read_bytes())
    picture[-1] ^= 1
    (tmp_path / "office.pgm").write_bytes(picture)
    digests.add(load_site(tmp_path / "office.toml").digest)
    assert len(digests) == 3


@pytest.mark.example
def test_the_example_office_has_the_size_of_its_map() -> None:
    site = load_site(EXAMPLE)
    assert (site.grid.columns, site.grid.rows, site.grid.cell_m) == (40, 24, 0.5)
    assert not site.grid.free[0].any()
