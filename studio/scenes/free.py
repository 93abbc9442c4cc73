"""Free roam: a bare floor and nothing to do."""

from studio.scenes.scene import Scene

SCENE = Scene(name="free", title="Free roam", about="A bare floor. Go where you like.")
