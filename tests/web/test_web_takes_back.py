"""What the page downloads can be sent back as it is; names of takes against the API's own paths."""

import pytest
from acted_takes import acted_take, record
from numpy.random import default_rng

from studio.takes.names import RESERVED
from studio.web.gateway import openapi


@pytest.mark.parametrize("format", ["lerobot", "mcap", "jsonl", "bvh"])
def test_a_download_can_be_imported_as_it_is(studio_live, format, tmp_path):
    client, name = studio_live.client, f"sent-as-{format}"
    # Recorded elsewhere: the studio keeps its own folder to itself once it has recorded there.
    record(acted_take("tilt", default_rng(1), seconds=3.0), tmp_path, name)
    (tmp_path / name).rename(studio_live.sessions / name)
    got = client.get(f"/api/takes/{name}/export", params={"format": format})
    file = got.headers["content-disposition"].partition('filename="')[2].rstrip('"')
    assert file.startswith(name)
    answer = client.post("/api/takes/import", files={"files": (file, got.content)})
    assert answer.status_code == 200, answer.text
    (back,) = answer.json()["takes"]
    assert back != name
    was, now = (client.get(f"/api/takes/{n}").json() for n in (name, back))
    assert abs(now["ticks"] - was["ticks"]) <= 1
    assert not now["damaged"]


def test_no_path_of_the_api_hides_a_take():
    """/api/takes/deleted is a list: no take may be called so."""
    paths = openapi()["paths"]
    methods = set(paths["/api/takes/{name}"])
    beside = {path.rpartition("/")[2]: set(about) for path, about in paths.items()
              if path.startswith("/api/takes/") and path.count("/") == 3}  # fmt: skip
    hidden = {name for name, own in beside.items() if own & methods and name != "{name}"}
    assert hidden
    assert hidden <= set(RESERVED)
