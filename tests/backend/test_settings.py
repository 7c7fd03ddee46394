from pathlib import Path

import pytest

from backend.log.migrate import prepare
from backend.settings import Settings


@pytest.mark.parametrize("name", ["plain", "fire? 1", "100%41", "a#b", "Übung 3"])
def test_the_database_lies_in_the_data_folder_however_that_is_called(tmp_path: Path, name: str) -> None:
    settings = Settings(data=tmp_path / name)
    settings.make_folder()
    prepare(settings.database_url)
    assert [path.name for path in tmp_path.iterdir()] == [name]
    assert (tmp_path / name / "firethread.db").is_file()
