"""What a server has to itself."""

import os
import signal
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


def test_a_folder_is_its_killed_servers_until_its_writer_has_ended_too(tmp_path: Path) -> None:
    data = tmp_path / "data"
    with running(data, "--no-worker") as first:
        (writer,) = first.writer_pids()
        os.kill(writer, signal.SIGSTOP)  # as one that waits for its disk
        first.kill_web()
        second = Server(data, ["--no-worker"])
        try:
            with pytest.raises(AssertionError, match="another firethread serves from"):
                second.start()
        finally:
            os.kill(writer, signal.SIGCONT)
        second.start()
        assert second.writer_pids() != [writer]
        second.stop()


def test_a_folder_that_was_given_back_can_be_held_again(tmp_path: Path) -> None:
    for _ in range(2):
        with held(tmp_path), pytest.raises(ConfigurationRefused), held(tmp_path, within_s=0.1):
            pass


def test_on_postgres_a_folder_is_only_where_the_token_is(postgres_url: str, tmp_path: Path) -> None:
    options = ("--no-worker", "--database", postgres_url)
    with running(tmp_path / "data", *options), running(tmp_path / "data", *options):
        pass
