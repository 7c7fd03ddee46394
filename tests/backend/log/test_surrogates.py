import pytest

from backend.errors import NotUnderstood
from backend.log.decode import judge
from backend.log.surrogates import MOST


def test_halves_of_characters_without_end_are_refused() -> None:
    body = b'{"gateway":"g","batch":"b","readings":["%s"]}' % (rb"\ud83d" * (MOST + 1))
    with pytest.raises(NotUnderstood):
        judge(body, 10, None)
