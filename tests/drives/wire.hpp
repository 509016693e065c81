// A bare hand at the bus for tests of the emulated drives: raw frames in stepped time, nothing of a master.
#pragma once

#include <initializer_list>
#include <memory>
#include <optional>
#include <vector>

#include "drivers/can/in_process_bus.hpp"
#include "sim/drives/drive_rack.hpp"

namespace foresight::sim {

using namespace std::chrono_literals;

CanFrame frame(std::uint32_t id, std::initializer_list<int> bytes = {});
std::vector<std::uint8_t> bytes_of(const CanFrame& frame);
/// "182#4007", for comparisons.
std::string text_of(const CanFrame& frame);
/// The frame of "182#4007".
CanFrame frame_of(const std::string& text);

/// A clock, a bus, a rack on it and our end.
class Wire {
 public:
  explicit Wire(const std::vector<NodeConfig>& nodes);

  void send(const CanFrame& frame) { end->send(frame); }
  void send(std::uint32_t id, std::initializer_list<int> bytes) { end->send(frame(id, bytes)); }
  /// The next frame with this identifier within `patience`; others are lost.
  std::optional<CanFrame> wait(std::uint32_t id, Duration patience = 50ms);
  /// Lets time pass, and gives all frames of it.
  std::vector<CanFrame> pass(Duration time);
  ShaftState shaft(std::size_t i = 0) const { return rack.shaft(i); }

  // SDO with node `node`.
  /// Expedited download; the abort code, 0 where it was taken, 1 where nobody answered.
  std::uint32_t download(int node, unsigned index, unsigned sub, std::int64_t value, int size);
  /// Expedited upload; nothing where it was aborted, whose code is then in `aborted`.
  std::optional<std::int64_t> upload(int node, unsigned index, unsigned sub = 0);
  std::uint32_t aborted = 0;
  std::uint16_t status(int node) { return static_cast<std::uint16_t>(upload(node, 0x6041).value_or(0)); }
  std::uint16_t control(int node, int controlword);  ///< the statusword 2 ms later
  void enable(int node);                             ///< operational, and controlwords 6, 7, 15

  // PowerCube.
  std::optional<float> real(int module, int parameter);
  std::uint32_t state(int module);
  std::optional<CanFrame> motion(int module, int motion, float value, int time_ms = -1);
  void home(int module);

  SteppedClock clock;
  InProcessBus bus{"can0", clock};
  std::unique_ptr<CanBus> end = bus.attach();
  DriveRack rack;
};

/// A drive whose joint has 1000 counts per unit and starts at 0, without soft limits.
NodeConfig cia402_drive(int node = 2);
NodeConfig powercube_module(int module = 5);

}  // namespace foresight::sim
