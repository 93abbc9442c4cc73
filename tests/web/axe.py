"""axe-core in a page: what it finds that some people could not use."""

from typing import Any

from browsing import click

from studio.paths import package_folder

AXE = package_folder("web_assets") / "node_modules/axe-core/axe.min.js"
"""Of the development packages: nothing of it is served."""
# viser's own frame is not ours to mend. Without preload: it would write styles into the page.
SETTLED = """async () => {
  const frame = () => new Promise(requestAnimationFrame);
  // What a closed panel hides stays among the animations, finished, for good.
  const colour = (a) => a instanceof CSSTransition && a.playState === 'running'
    && a.transitionProperty.includes('color');
  const fading = () => document.getAnimations().some(colour); // bars move with every tick
  for (let quiet = 0; quiet < 3; quiet = fading() ? 0 : quiet + 1) await frame();
}"""
FOUND = """async () => {
  const options = { preload: false, resultTypes: ['violations'] };
  const { violations } = await axe.run({ exclude: [['#view']] }, options);
  return violations.flatMap(({ id, nodes }) => nodes.map(({ html, any, all, none }) =>
    `${id}: ${[...any, ...all, ...none][0]?.message} in ${html.slice(0, 200)}`));
}"""


def put_into(page: Any) -> None:
    """For as long as the page is not loaded anew."""
    page.evaluate(AXE.read_text("utf-8"))


def find_nothing(page) -> None:
    """axe has nothing to say, in the dark nor in the light."""
    for theme in ("dark", "light"):
        if page.evaluate("() => document.documentElement.dataset.theme") != theme:
            click(page, "#theme")
        page.evaluate(SETTLED)  # a colour on its way is none of ours
        assert page.evaluate(FOUND) == [], theme
