"""OpenCV that is missing, and pictures that are none."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest

from surveillance_domain.vision.opencv import BadImage, VisionMissing, decoded, opencv, read_image, write_png


@pytest.mark.example
def test_the_extra_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "cv2", None)
    with pytest.raises(VisionMissing, match=r"factored-pomdp\[vision\]"):
        opencv()


@pytest.mark.example
@pytest.mark.parametrize("content", [b"", b"no picture", b"\xff\xd8\xff\xe0"])
def test_bytes_that_are_no_picture(content: bytes) -> None:
    with pytest.raises(BadImage, match="no picture"):
        decoded(content)


@pytest.mark.example
def test_a_picture_file_comes_back(tmp_path: Path) -> None:
    picture = np.zeros((4, 6, 3), dtype=np.uint8)
    picture[1, 2] = (10, 20, 30)
    write_png(tmp_path / "one.png", picture)
    assert [path.name for path in tmp_path.iterdir()] == ["one.png"]
    np.testing.assert_array_equal(read_image(tmp_path / "one.png"), picture)


@pytest.mark.example
def test_files_are_named(tmp_path: Path) -> None:
    (tmp_path / "text.jpg").write_text("text")
    with pytest.raises(BadImage, match=r"text\.jpg: .*expected a JPEG or PNG"):
        read_image(tmp_path / "text.jpg")
    with pytest.raises(BadImage, match=r"none\.jpg: no such file"):
        read_image(tmp_path / "none.jpg")
