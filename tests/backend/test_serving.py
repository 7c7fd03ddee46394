"""What a server has to itself."""

from pathlib import Path

import pytest

from backend.serving import ConfigurationRefused, held
from tests.running import Server, running


def test_a_folder_has_one_server_at_a_time_and_is_free_once_that_is_killed(tmp_path: Path) -> None:
    data = tmp_path / "data"
    with running(data, "--no-worker") as first:
        second = Server(data, ["--no-worker"])
        with pytest.raises(AssertionError, match="another firethread serves from"):
            second.start()
        first.kill_web()
        second.start()
        second.stop()


def test_a_folder_that_was_given_back_can_be_held_again(tmp_path: Path) -> None:
    for _ in range(2):
        with held(tmp_path), pytest.raises(ConfigurationRefused), held(tmp_path):
            pass


def test_on_postgres_a_folder_is_only_where_the_token_is(postgres_url: str, tmp_path: Path) -> None:
    options = ("--no-worker", "--database", postgres_url)
    with running(tmp_path / "data", *options), running(tmp_path / "data", *options):
        pass
