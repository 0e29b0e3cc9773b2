"""A page looked at by a browser without a window: what a script in it has seen."""

from __future__ import annotations

import html
import json
import re
import shutil
import subprocess

CHROMIUM = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)

# A browser without a window paints when it likes; frames come by the clock instead, which is a virtual one.
CLOCK = """<script>
window.requestAnimationFrame = (then) => setTimeout(() => then(performance.now()), 16);
window.cancelAnimationFrame = clearTimeout;
</script>"""

OPTIONS = [
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--virtual-time-budget=20000",
]


def looked_at(page, script, folder, *options):
    """What a script at the end of a page leaves in the title, as JSON."""
    target = folder / "page.html"
    page = page.replace("</head>", CLOCK + "</head>").replace("</body>", script + "</body>")
    target.write_text(page, encoding="utf-8")
    command = [CHROMIUM, *OPTIONS, f"--user-data-dir={folder / 'profile'}", "--dump-dom", *options]
    done = subprocess.run(
        [*command, target.as_uri()], capture_output=True, text=True, timeout=120, check=True
    )
    return json.loads(html.unescape(re.search("<title>(.*?)</title>", done.stdout)[1]))
