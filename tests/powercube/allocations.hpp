// Counts what is allocated, by replacing operator new in this test program.
#pragma once

#include <cstddef>

namespace foresight::powercube {

/// Allocations of this thread so far.
std::size_t allocations() noexcept;

}  // namespace foresight::powercube
