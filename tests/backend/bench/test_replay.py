import pytest

from backend.bench import replay


def test_the_table_has_a_row_for_each_size(capsys: pytest.CaptureFixture[str]) -> None:
    replay.run(rounds=1, readings=2_000)
    rows = capsys.readouterr().out.splitlines()[-len(replay.SIZES) :]
    assert [int(row.split()[0]) for row in rows] == list(replay.SIZES)
    assert all(float(row.split()[3]) > 0 for row in rows)
