#include "exocarp/cpp/grid.h"
#include "exocarp/src/vdb/bridge.rs.h"

#include <openvdb/tools/Diagnostics.h>
#include <tbb/task_arena.h>

#include <stdexcept>

namespace exocarp::vdb {

namespace {

using Checks = openvdb::tools::CheckLevelSet<openvdb::FloatGrid>;

std::string run(Checks& checks, std::uint8_t test)
{
    switch (test) {
    case 1: return Checks::checkValueType();
    case 2: return checks.checkClassType();
    case 3: return checks.checkTransform();
    case 4: return checks.checkBackground();
    case 5: return checks.checkTiles();
    case 6: return checks.checkFinite();
    case 7: return checks.checkRange();
    case 8: return checks.checkInactiveValues();
    case 9: return checks.checkEikonal();
    default: throw std::invalid_argument("there are nine tests");
    }
}

} // namespace

rust::String FloatGrid::check(std::uint8_t test, std::int32_t threads) const
{
    std::string message;
    tbb::task_arena arena(threads);
    arena.execute([&] {
        Checks checks(*mHeld->grid);
        message = run(checks, test);
    });
    return text(message);
}

} // namespace exocarp::vdb
