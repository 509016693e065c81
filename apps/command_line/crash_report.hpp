// Where a program was when it crashed, in a line that whoever met it can report.
#pragma once

namespace foresight {

/// From now on a signal that tells of a mistake (SIGSEGV, SIGBUS, SIGILL, SIGFPE, SIGABRT) writes a last line on stderr
/// before it ends the program as it would have, with its core: "foresight: crashed (Segmentation fault) in thread
/// 'foresight'; please report: foresight+0x12ab < libembree3.so.3+0x34cd < ...", innermost first, as `addr2line -e FILE
/// OFFSET` takes it. In a thread that has no stack left, other than the calling one, it says nothing.
void report_crashes();

}  // namespace foresight
