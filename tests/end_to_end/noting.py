"""What stood on the board, noted in the page: however slow the machine is, no moment is missed."""

from playwright.sync_api import Page


class BoardNoted:
    """What is noted of the board.

    Args:
        page: a page of the browser.
    """

    def __init__(self, page: Page) -> None:
        self.page = page

    def notes_the_board(self) -> None:
        """From now on every change of a line is noted."""
        self.page.evaluate(
            """() => {
              window.noted = [];
              setInterval(() => {
                for (const row of document.querySelectorAll('[data-testid=responder]')) {
                  const of = (part) => row.querySelector(part)?.textContent.trim() ?? '';
                  const name = of('.name');
                  const line = [name, of('[data-testid=status]'), of('[data-testid=age]')];
                  const last = window.noted.findLast(([noted]) => noted === name);
                  if (String(last) !== String(line)) window.noted.push(line);
                }
              }, 20);
            }"""
        )

    @property
    def notes(self) -> list[tuple[str, str, str]]:
        """Name, status and age, in the order in which they came."""
        return [(name, status, age) for name, status, age in self.page.evaluate("window.noted")]

    def noted(self, name: str) -> dict[str, str]:
        """The words that a responder has had for its status, in their order, each with its first age."""
        found: dict[str, str] = {}
        for of, status, age in self.notes:
            if of == name:
                found.setdefault(status, age)
        return found
