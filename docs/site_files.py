"""A hook of mkdocs: the pages and pictures of the whole repository, each where it lies there.

So one link works alike in an editor, on a forge and on the site, and no text is kept twice.
"""

from pathlib import Path

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files

REPOSITORY = Path(__file__).resolve().parents[1]
SHOWN = (
    "*.md", "CITATION.cff", "LICENSE", "docs/**/*.md", "docs/*.py", "docs/*.css", "models/**/*.md",
    "models/**/*.png", "models/report/*", "models/policy/onnx_runner.py", "sessions/*.md",
    "web_assets/screenshots/*",
)  # fmt: skip


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """What the theme brings, and SHOWN in place of the one folder that mkdocs looks into."""
    for own in list(files.documentation_pages()):
        files.remove(own)
    for path in sorted({path for glob in SHOWN for path in REPOSITORY.glob(glob)}):
        if path.name != Path(__file__).name:
            name = path.relative_to(REPOSITORY).as_posix()
            files.append(File.generated(config, name, abs_src_path=str(path)))
    return files
