// Counts what is allocated, by replacing operator new in the test program that this is
// linked into (compile tests/support/allocations.cpp with it).
#pragma once

#include <cstddef>

namespace foresight {

/// Allocations of this thread so far.
std::size_t allocations() noexcept;

}  // namespace foresight
