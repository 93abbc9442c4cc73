"""Every declared command over HTTP: its path, its words and its limits are those of its class."""

import inspect

import pytest

from studio.live.commands import COMMANDS
from studio.web.commands_api import body_of

ASKED = [command for command in COMMANDS if command.path]
LIMITS = {
    "Ge": ("minimum", "ge"),
    "Le": ("maximum", "le"),
    "MinLen": ("minLength", "min_length"),
    "MaxLen": ("maxLength", "max_length"),
}


@pytest.fixture(scope="module")
def schema(studio_at):
    return studio_at.client.get("/api/docs").json()


def limits_of(field):
    """What a field's declaration allows, in JSON Schema's words."""
    for limit in field.metadata:
        kind = type(limit).__name__
        if kind == "OneOf":
            yield "enum", list(limit.known)
        elif kind in LIMITS:
            said, attribute = LIMITS[kind]
            if said.endswith("Length") and str(field.annotation).startswith("tuple"):
                said = said.replace("Length", "Items")
            yield said, getattr(limit, attribute)


@pytest.mark.parametrize("command", COMMANDS, ids=lambda command: command.__name__)
def test_every_command_says_what_it_does_and_cannot_be_changed_on_its_way(command):
    assert len(command.__doc__) > 20
    assert "apply" in vars(command)
    assert command.model_config["frozen"]


@pytest.mark.parametrize("command", ASKED, ids=lambda command: command.path)
def test_every_command_with_a_path_is_in_the_schema_with_its_words_and_limits(schema, command):
    post = schema["paths"][f"/api/{command.path}"]["post"]
    assert post["description"] == inspect.getdoc(command)
    assert post["tags"] == [command.tag]
    body = body_of(command)
    assert ("requestBody" in post) == (body is not None)
    shown = schema["components"]["schemas"][body.__name__]["properties"] if body else {}
    for name, field in command.model_fields.items():
        if name == command.sender or f"{{{name}}}" in command.path:
            assert name not in shown
            continue
        said = shown[name]
        said = {**said, **said.get("anyOf", [{}])[0]}
        for key, value in limits_of(field):
            assert said[key] == value, (name, key)
        if said.get("type") == "string":
            assert {"enum", "maxLength"} & said.keys(), f"{name} may be of any length"


@pytest.mark.parametrize("command", ASKED, ids=lambda command: command.path)
def test_every_command_with_a_path_answers_there_and_a_misfit_says_why(studio_live, command):
    path = f"/api/{command.path.replace('{name}', 'nobody')}"
    assert studio_live.client.get(path).status_code in (200, 404, 405)
    answer = studio_live.client.post(path, content=b"[]")
    if body_of(command) is None:
        assert answer.status_code in (200, 409)
    elif "{name}" in command.path:
        assert answer.status_code == 404
        assert "unknown take" in answer.json()["why"]
    else:
        assert answer.status_code == command.misfit_status
        assert answer.json()["why"]


def test_only_what_frees_a_stopped_robot_must_have_been_sent_after_the_stop():
    assert [command.__name__ for command in COMMANDS if command.releases] == ["Reset", "Arm"]


@pytest.mark.parametrize(
    ("path", "body", "says"),
    [
        ("/api/seek", {"speed": 99.0}, "less than or equal to 4"),
        ("/api/gain", {"name": "dead_zone", "value": 1.9}, "between 0.0 and 0.5"),
        ("/api/collect/action", {"action": "dance"}, "unknown action"),
        ("/api/style", {"style": "waltz"}, "circles"),
    ],
)
def test_a_value_outside_its_limits_gets_409_with_those_that_work(studio_live, path, body, says):
    answer = studio_live.client.post(path, json=body)
    assert answer.status_code == 409
    assert says in answer.json()["why"]


def test_a_stop_names_the_page_that_asked(studio_live):
    stopped = studio_live.client.post("/api/stop", headers={"X-Studio-Page": "page-7"}).json()
    assert "emergency stop by page-7" in stopped["why"]
    stopped = studio_live.client.post("/api/stop", json={"by": "somebody else"}).json()
    assert "emergency stop by api" in stopped["why"]
    assert studio_live.client.post("/api/reset").status_code == 200
    assert studio_live.client.post("/api/arm").status_code == 200
