from rocking import *
