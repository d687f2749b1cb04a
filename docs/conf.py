"""Settings of the guide; `packaging/guide.sh` builds it."""

import os
import re
from pathlib import Path


def version_of(manifest):
    """Version of the workspace, from its Cargo.toml."""
    return re.search(r'^version = "([^"]+)"', manifest.read_text(), re.MULTILINE).group(1)


project = "riprap"
author = "The riprap authors"
release = version = version_of(Path(os.environ["RIPRAP_SOURCE"]) / "Cargo.toml")
extensions = ["myst_parser"]
source_suffix = {".md": "markdown"}
# links to headings, as `page.md#heading`
myst_heading_anchors = 4
myst_enable_extensions = ["deflist", "attrs_inline", "attrs_block", "colon_fence"]
# scenes are RON, which has no highlighter of its own; Rust's is closest
highlight_language = "text"
# a word in back ticks that is unknown, a heading that is skipped, a page that nobody lists: all are errors of the guide
nitpicky = True
html_theme = "furo"
html_title = f"riprap {version}"
html_static_path = ["static"]
html_css_files = ["guide.css"]
html_copy_source = False
html_show_sphinx = False
html_show_copyright = False
# nothing is loaded from elsewhere: no fonts, no icons
html_theme_options = {"footer_icons": [], "top_of_page_buttons": []}


def setup(app):
    """Scenes are highlighted by the lexer of Rust, whose literals and comments are the same."""
    from pygments.lexers.rust import RustLexer

    class Ron(RustLexer):
        """Rusty Object Notation."""

        name = "RON"

    app.add_lexer("ron", Ron)
