"""What a page of the study asks for, read from its HTML as a browser would."""

from __future__ import annotations

from dataclasses import dataclass, field
from html.parser import HTMLParser


@dataclass
class Form:
    """A form.

    Attributes:
        action: where it is sent to.
        hidden: names and values of its hidden fields.
        choices: for each name of radio buttons, the values.
        texts: names of the fields for text.
        buttons: for each name of buttons that send it, the values.
    """

    action: str
    hidden: dict[str, str] = field(default_factory=dict[str, str])
    choices: dict[str, list[str]] = field(default_factory=dict[str, list[str]])
    texts: list[str] = field(default_factory=list[str])
    buttons: dict[str, list[str]] = field(default_factory=dict[str, list[str]])

    @property
    def stage(self) -> str | None:
        """The stage that it belongs to."""
        return self.hidden.get("stage")


@dataclass
class Page:
    """A page.

    Attributes:
        heading: of the page.
        forms: in their order.
        socket: path of the websocket for steering and for measuring the connection.
        steers: whether there is something to steer.
    """

    heading: str = ""
    forms: list[Form] = field(default_factory=list[Form])
    socket: str | None = None
    steers: bool = False

    @property
    def form(self) -> Form | None:
        """The form of the stage; not the one for withdrawing."""
        return next((form for form in self.forms if form.stage), None)

    @property
    def withdrawal(self) -> Form | None:
        """The form for withdrawing."""
        return next((form for form in self.forms if form.action.endswith("/withdraw")), None)


def read_page(html: str) -> Page:
    """What ``html`` asks for."""
    reader = _Reader()
    reader.feed(html)
    reader.close()
    return reader.page


class _Reader(HTMLParser):
    def __init__(self) -> None:
        super().__init__()
        self.page = Page()
        self._form: Form | None = None
        self._in_heading = False

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        values = {name: value or "" for name, value in attrs}
        if "data-socket" in values:
            self.page.socket = values["data-socket"]
            self.page.steers = values.get("id") == "steer"
        if tag == "h1":
            self._in_heading = True
        elif tag == "form":
            self._form = Form(values.get("action", ""))
            self.page.forms.append(self._form)
        elif self._form is not None and "name" in values:
            self._field(self._form, tag, values)

    def handle_endtag(self, tag: str) -> None:
        if tag == "form":
            self._form = None
        elif tag == "h1":
            self._in_heading = False

    def handle_data(self, data: str) -> None:
        if self._in_heading:
            self.page.heading += data

    @staticmethod
    def _field(form: Form, tag: str, values: dict[str, str]) -> None:
        name, value = values["name"], values.get("value", "")
        if tag == "textarea":
            form.texts.append(name)
        elif tag == "button":
            form.buttons.setdefault(name, []).append(value)
        elif tag == "input" and values.get("type") == "hidden":
            form.hidden[name] = value
        elif tag == "input" and values.get("type") == "radio":
            form.choices.setdefault(name, []).append(value)
