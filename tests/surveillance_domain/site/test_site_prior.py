"""The prior over cells: read from a file beside the site file, checked, part of the digest, written again."""

from __future__ import annotations

from pathlib import Path

import pytest

from surveillance_domain.site.faults import SiteError
from surveillance_domain.site.load import load_site
from surveillance_domain.site.prior import prior_text
from surveillance_domain.site.site import Site

BUILTIN = Path(__file__).parents[3] / "surveillance_domain" / "site" / "builtin"


def site_with(folder: Path, prior: str, named: str = "where.csv") -> Site:
    """The site tiny, 5 x 4 cells, with a prior."""
    text = (BUILTIN / "tiny.toml").read_text()
    assert "prior" not in text
    (folder / "site.toml").write_text(text.replace("[targets]\n", f'[targets]\nprior = "{named}"\n'))
    (folder / "where.csv").write_text(prior)
    return load_site(folder / "site.toml")


@pytest.mark.example
def test_weights_become_probabilities_and_missing_cells_are_zero(tmp_path: Path) -> None:
    site = site_with(tmp_path, "column,row,weight\n0,0,3\n4,3,1\n1,0,0\n")
    assert site.prior is not None
    assert site.prior[0] == 0.75  # [0, 0] is the first free cell, [4, 3] the last
    assert site.prior[-1] == 0.25
    assert site.prior.sum() == 1.0
    assert load_site("tiny").prior is None


@pytest.mark.example
def test_what_is_written_is_read_again(tmp_path: Path) -> None:
    site = site_with(tmp_path, "column,row,weight\n0,0,3\n4,3,1\n")
    assert site.prior is not None
    text = prior_text(site.prior, site.grid)
    assert text == "column,row,weight\n0,0,0.75\n4,3,0.25\n"
    again = site_with(tmp_path, text)
    assert again.prior is not None
    assert again.prior.tolist() == site.prior.tolist()


@pytest.mark.example
def test_the_digest_holds_the_prior(tmp_path: Path) -> None:
    digests = {site_with(tmp_path, f"column,row,weight\n0,0,{weight}\n1,0,1\n").digest for weight in (1, 2, 2)}
    assert len(digests) == 2


@pytest.mark.example
def test_every_fault_of_the_file_comes_at_once(tmp_path: Path) -> None:
    lines = ["column,row,weight", "5,0,1", "0,0,-1", "1,0,nan", "2,0,1", "2,0,1", "a,b,c", "1,1", "0,1,1,1"]
    with pytest.raises(SiteError) as caught:
        site_with(tmp_path, "\n".join(lines))
    told = [(fault.where, fault.found) for fault in caught.value.faults]
    assert told == [
        ("targets.prior", "in where.csv, line 2: cell [5, 0], which is not on the map"),
        ("targets.prior", "in where.csv, line 3: weight -1"),
        ("targets.prior", "in where.csv, line 4: weight nan"),
        ("targets.prior", "in where.csv, line 6: cell [2, 0], as on line 5"),
        ("targets.prior", "in where.csv, line 7: a,b,c"),
        ("targets.prior", "in where.csv, line 8: 1,1"),
        ("targets.prior", "in where.csv, line 9: 0,1,1,1"),
    ]


@pytest.mark.example
@pytest.mark.parametrize(
    ("prior", "named", "told"),
    [
        ("column,row,weight\n0,0,0\n", "where.csv", "in where.csv: no weight above 0"),
        ("", "where.csv", "in where.csv, line 1: nothing; expected the header column,row,weight"),
        ("0,0,1\n", "where.csv", "line 1: 0,0,1; expected the header"),
        ("column,row,weight\n0,0,1\n", "unifrom", '"unifrom", no such file or directory; expected "uniform", or'),
        ("column,row,weight\n" + "9,9,1\n" * 25, "where.csv", "15 more faults"),
    ],
)
def test_what_is_no_prior_is_refused(tmp_path: Path, prior: str, named: str, told: str) -> None:
    with pytest.raises(SiteError) as caught:
        site_with(tmp_path, prior, named)
    assert told in str(caught.value)


@pytest.mark.example
def test_blocked_cells_have_no_weight(tmp_path: Path) -> None:
    text = (BUILTIN / "junction.toml").read_text()
    assert 'prior = "uniform"' in text
    text = text.replace('prior = "uniform"', 'prior = "where.csv"')
    (tmp_path / "site.toml").write_text(text)
    grid = load_site("junction").grid
    blocked = next((c, r) for r in range(grid.rows) for c in range(grid.columns) if not grid.free[r, c])
    (tmp_path / "where.csv").write_text(f"column,row,weight\n{blocked[0]},{blocked[1]},1\n")
    with pytest.raises(SiteError, match="which is blocked; expected free cells only"):
        load_site(tmp_path / "site.toml")
