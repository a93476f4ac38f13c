from ._command import Result as Result, check as check, command as command, diff as diff, record as record
from ._command import replay as replay
from ._control_bench import ControllerBench as ControllerBench
from ._controller import Controller as Controller
from ._errors import Diagnostic as Diagnostic, Error as Error, UnknownName as UnknownName
from ._trace import Moment as Moment, Pictures as Pictures, Trace as Trace
