// All of vdb.h but the tools, in one go: the compiler takes longer over the headers of OpenVDB than over this.
#include "exocarp/cpp/grid.cc"
#include "exocarp/cpp/read.cc"
#include "exocarp/cpp/write.cc"
