// What stands in the lab away from the table: a cabinet with things on it, a stool, a bin.
#pragma once

#include "sim/lab_builder.hpp"

namespace foresight::sim {

void add_furniture(LabBuilder& builder);

}  // namespace foresight::sim
