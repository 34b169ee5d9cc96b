// the stand-in of fork_join.h
#include "tbb/fork_join.h"
