// A small CiA 402 slave for tests, at the other end of an in-process bus. It shares no code with the driver.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <set>
#include <vector>

#include "common/clock.hpp"
#include "drivers/can/in_process_bus.hpp"
#include "drivers/canopen/canopen_network.hpp"

namespace foresight::canopen {

struct ScriptedSlave {
  struct Command {
    std::uint16_t word;
    std::int32_t target;
  };
  struct Object {
    std::uint32_t value = 0;
    int bytes = 4;
    bool keeps = true;  // false: takes a write and forgets it
  };

  ScriptedSlave(InProcessBus& bus, SteppedClock& clock, int id);
  Object& object(std::uint16_t index, std::uint8_t sub = 0) { return objects[std::uint32_t{index} << 8 | sub]; }
  void remove(std::uint16_t index);
  void step(RobotTime now);
  void reboot();                  // power comes back: everything forgotten
  void fail(std::uint16_t code);  // into the fault state, with an emergency message
  void send(std::uint32_t function, std::vector<std::uint8_t> bytes);

  int node;
  std::unique_ptr<CanBus> end;
  std::map<std::uint32_t, Object> objects;
  std::vector<Command> commands;      // every RPDO1, in order
  std::vector<std::uint32_t> writes;  // index << 8 | sub
  bool mute = false;                  // hears and says nothing
  bool sends_pdos = true;
  bool stuck_fault = false;  // cannot be reset
  bool homing_fails = false;
  std::uint8_t nmt = 0x7f;
  int state = 0x40;  // low bits of the status word
  std::int32_t position = 1000, velocity = 0;
  int heartbeats_heard = 0, syncs = 0, edges = 0;  // edges: set-points taken in profile position mode

 private:
  void answer_sdo(const CanFrame& request);
  void apply(Command command);
  void sync();
  std::uint16_t status() const;
  int mode() const { return static_cast<std::int8_t>(objects.at(0x606100).value); }

  Command waiting_{0, 0};
  bool has_waiting_ = false;
  std::uint16_t last_word_ = 0;
  bool acknowledged_ = false, homed_ = false, homing_error_ = false;
  int homing_left_ = 0;
  RobotTime next_heartbeat_;
};

/// A master with slaves of nodes 1, 2, ..., all in one stepped time.
struct CanopenRig {
  explicit CanopenRig(int drives = 1, OperationMode mode = OperationMode::cyclic_position);
  Cia402Config drive_config(int node) const;
  void configure();
  /// Runs so many cycles of the loop, with `position` as set-point in each where it is given.
  void cycles(int count, std::optional<double> position = std::nullopt, double velocity = 0);
  void enable();
  DriveFeedback feedback(std::size_t i = 0) { return network->drives()[i]->feedback(); }
  ScriptedSlave& slave(std::size_t i = 0) { return *slaves[i]; }
  Cia402Drive& drive(std::size_t i = 0) { return network->drive(i); }

  SteppedClock clock;
  InProcessBus bus{"can0", clock};
  std::unique_ptr<CanBus> master, stranger;
  std::vector<std::unique_ptr<ScriptedSlave>> slaves;
  OperationMode mode;
  NetworkConfig config;
  std::unique_ptr<CanopenNetwork> network;
};

}  // namespace foresight::canopen
