from . import models as models
from .assessment import assess as assess
from .calibration import calibrate as calibrate
from .conditioning import condition as condition
from .config import Config as Config
from .config import load_config as load_config
from .conversion import write as write
from .errors import ConfigError as ConfigError
from .errors import RecordFormatError as RecordFormatError
from .errors import RecordRefused as RecordRefused
from .errors import ResultsError as ResultsError
from .errors import RockpulseError as RockpulseError
from .errors import UnitError as UnitError
from .half_wave import HalfWaves as HalfWaves
from .half_wave import half_waves as half_waves
from .intensity import intense_phase as intense_phase
from .obspy_trace import from_trace as from_trace
from .obspy_trace import to_trace as to_trace
from .readers import read as read
from .record import Record as Record
from .store import load as load
from .store import save as save

__version__: str
