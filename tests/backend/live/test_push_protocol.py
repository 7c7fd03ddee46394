"""Ready-made WebSocket frames."""

import pytest
from websockets.frames import Frame, Opcode

from backend.live.push_protocol import text_frame


@pytest.mark.parametrize("size", [0, 1, 125, 126, 127, 65_535, 65_536, 1_000_000])
def test_a_ready_made_frame_is_what_a_websocket_library_would_send(size: int) -> None:
    payload = b"x" * size
    assert text_frame(payload) == Frame(Opcode.TEXT, payload).serialize(mask=False)
