"""The sheet on which a commander signs in."""

from playwright.sync_api import Page


class SignInSeen:
    """What is seen of it.

    Args:
        page: a page of the browser.
    """

    def __init__(self, page: Page) -> None:
        self.page = page

    @property
    def is_asked_to_sign_in(self) -> bool:
        """Whether the sheet is shown."""
        return self.page.get_by_test_id("sign-in").is_visible()

    def signs_in(self, token: str) -> None:
        """Give the access token."""
        self.page.get_by_label("Access token").fill(token)
        self.page.get_by_role("button", name="Sign in").click()
