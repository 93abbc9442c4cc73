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
    refused = {"409", *([str(command.misfit_status)] if body else [])}
    refused |= {"404"} if "{name}" in command.path else set()
    assert post["responses"].keys() == {"200", *refused}
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


@pytest.fixture(scope="module")
def take(studio_at):
    """The name of a take of a moment."""
    name = studio_at.client.post("/api/takes/start").json()["name"]
    studio_at.wait(lambda state: (state["recording"] or {"ticks": 0})["ticks"])
    studio_at.client.post("/api/takes/stop")
    yield name
    studio_at.client.delete(f"/api/takes/{name}")


def asked_for(schema, take):
    """(method, URL, statuses of a refusal, properties) of every route with a body in JSON."""
    for path, routes in schema["paths"].items():
        for method, route in routes.items():
            content = route.get("requestBody", {}).get("content", {}).get("application/json")
            if content is not None:
                ref = content["schema"].get("$ref") or content["schema"]["anyOf"][0]["$ref"]
                part = schema["components"]["schemas"][ref.rpartition("/")[2]]
                url = path.replace("{name}", take)
                yield method, url, route["responses"].keys() - {"200"}, part["properties"]


def test_a_key_that_is_none_is_refused_everywhere_with_those_that_are(studio_live, schema, take):
    asked = list(asked_for(schema, take))
    assert len(asked) > 20
    for method, url, refusals, properties in asked:
        answer = studio_live.client.request(method, url, json={"colour": 1})
        assert str(answer.status_code) in refusals, url
        known = ", ".join(sorted(properties))
        assert f"unknown key 'colour'; known: {known}" in answer.json()["why"], url
    items = [{"task": "tilt", "colour": 1}]
    answer = studio_live.client.post("/api/collect/plan", json={"items": items})
    assert "items.0: unknown key 'colour'; known: difficulty, seconds" in answer.json()["why"]


NO_FIT = {"boolean": ["yes", 1], "number": ["1", True], "integer": ["1", True, 1.0]}
"""What would become a boolean or a number, were it not refused, by JSON Schema's type."""


def misfits_of(schema, said):
    """(value, where in it, type) for all in a property that is a boolean or a number."""
    said = schema["components"]["schemas"].get(said.get("$ref", "").rpartition("/")[2], said)
    for part in said.get("anyOf", ()):
        yield from misfits_of(schema, part)
    kind = said.get("type")
    for value in NO_FIT.get(kind, ()):
        yield value, "", kind
    for name, inner in said.get("properties", {}).items():
        for value, where, of in misfits_of(schema, inner):
            yield {name: value}, f".{name}{where}", of
    if kind == "array":
        items = said.get("prefixItems", [said.get("items")])
        for value, where, of in misfits_of(schema, items[0]):
            yield [value] * len(items), f".0{where}", of


def test_a_boolean_or_a_number_is_one_everywhere(studio_live, schema, take):
    found = []
    for method, url, refusals, properties in asked_for(schema, take):
        for name, said in properties.items():
            for value, where, kind in misfits_of(schema, said):
                answer = studio_live.client.request(method, url, json={name: value})
                assert str(answer.status_code) in refusals, url
                why = f"{name}{where}: Input should be a valid {kind}"
                assert why in answer.json()["why"], (url, value)
                found.append((name, where, kind))
    assert {
        ("warp", ".0.0", "number"),
        ("items", ".0.takes", "integer"),
        ("value", "", "number"),
    } <= set(found)
    assert sum(kind == "boolean" for *_, kind in found) > 16


def test_a_whole_number_is_a_number(studio_live):
    asked = {"name": "tilt_gain", "value": 1}
    assert studio_live.client.post("/api/gain", json=asked).status_code == 200


def test_only_what_frees_a_stopped_robot_must_have_been_sent_after_the_stop():
    frees = {command.__name__ for command in COMMANDS if command.releases}
    assert frees == {"Reset", "Arm", "PlaceRobot"}


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
    for release in ("/api/reset", "/api/arm"):
        answer = studio_live.client.post(release)
        assert answer.status_code == 200, answer.text
