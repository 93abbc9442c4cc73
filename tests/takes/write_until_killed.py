"""Record ticks for ever, printing each one's number once it is flushed; made to be killed."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))

from make_ticks import make_ticks

from studio.takes.record.recorder import Recorder

recorder = Recorder(Path(sys.argv[1]))
recorder.start(name=sys.argv[2])
ticks = list(make_ticks(2000))
sys.stdout.write("recording\n")
sys.stdout.flush()
for tick in ticks:
    recorder.append(tick)
    sys.stdout.write(f"{tick.index}\n")
    sys.stdout.flush()
sys.stdout.write("done\n")
