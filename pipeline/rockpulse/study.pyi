from rockpulse.studies.paper import *
