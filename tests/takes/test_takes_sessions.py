"""Takes grouped by operator and day."""

from datetime import date

import pytest

from studio.errors import StudioError
from studio.takes.session_library import SessionLibrary
from studio.takes.sessions import SessionBook, session_name


def test_takes_of_one_operator_and_day_are_one_session(tmp_path):
    book = SessionBook(tmp_path)
    book.add("Ada Lovelace", "take-1", notes="warm-up", calibration={"leg_length": 0.9})
    session = book.add("Ada Lovelace", "take-2")
    book.add("Ada Lovelace", "take-2")
    book.add("Bob", "take-3")
    assert session.notes == "warm-up"
    assert session.calibration == {"leg_length": 0.9}
    assert book.read(session.name).takes == ["take-1", "take-2"]
    assert {s.operator for s in book.list()} == {"Ada Lovelace", "Bob"}


def test_names_of_sessions_are_fit_for_files():
    assert session_name("../../etc", date(2026, 11, 22)) == "etc-20261122"
    assert session_name("  ", date(2026, 11, 22)) == "me-20261122"


def test_notes_are_replaced_and_unknown_sessions_list_the_known(tmp_path):
    book = SessionBook(tmp_path)
    name = book.add("Ada", "take-1").name
    book.note(name, "second thoughts")
    assert book.read(name).notes == "second thoughts"
    with pytest.raises(StudioError, match=f"known: {name}"):
        book.read("nobody-20200101")
    with pytest.raises(StudioError, match="no name for a session"):
        book.read("../secret")


def test_a_damaged_session_is_left_out_of_the_list_and_said_when_read(tmp_path):
    book = SessionBook(tmp_path)
    name = book.add("Ada", "take-1").name
    (book.folder / "broken-20200101.json").write_text("{")
    assert [s.name for s in book.list()] == [name]
    with pytest.raises(StudioError, match="damaged"):
        book.read("broken-20200101")


def test_sessions_are_no_takes(tmp_path):
    SessionBook(tmp_path).add("Ada", "take-1")
    assert SessionLibrary(tmp_path).list() == []
