#pragma once

namespace foresight::link {

/// Reads every type of the IDL from the topic "in/TYPE", without its colons, as the structs that Cyclone's own IDL
/// compiler made of it, and writes each sample to "out/TYPE". Does not return.
[[noreturn]] void echo_as_idl_says(int domain, const char* settings);

}  // namespace foresight::link
