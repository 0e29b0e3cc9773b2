"""The README as a package index shows it: links into the source tree lead nowhere there and become text."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

from hatchling.metadata.plugin.interface import MetadataHookInterface


def without_links_into_the_tree(text: str) -> str:
    """Drop pictures of the tree, and keep the words of links into it."""
    text = re.sub(r"!\[[^\]]*\]\((?!https?:)[^)]*\)\n*", "", text)
    return re.sub(r"\[([^\]]+)\]\((?!https?:)[^)]+\)", r"\1", text)


class ReadmeHook(MetadataHookInterface):
    """Hands hatchling the README."""

    def update(self, metadata: dict[str, Any]) -> None:
        """Set the project's readme."""
        text = Path(self.root, "README.md").read_text(encoding="utf-8")
        metadata["readme"] = {
            "content-type": "text/markdown",
            "text": without_links_into_the_tree(text),
        }
