from rockpulse.views.plots import *
