from ._command import Result as Result, check as check, command as command, diff as diff, record as record
from ._command import audit as audit, history as history, inspect as inspect, replay as replay, report as report
from ._command import sweep as sweep
from ._control_bench import ControllerBench as ControllerBench
from ._controller import Controller as Controller
from ._errors import Diagnostic as Diagnostic, Error as Error, NoSuchFile as NoSuchFile, UnknownName as UnknownName
from ._tap import Tap as Tap
from ._trace import Moment as Moment, Pictures as Pictures, Trace as Trace

__version__: str
