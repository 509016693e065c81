#include "scripted_slave.hpp"

namespace foresight::canopen {

using namespace std::chrono_literals;

ScriptedSlave::ScriptedSlave(InProcessBus& bus, SteppedClock& clock, int id) : node(id), end(bus.attach()) {
  reboot();
  clock.every(1ms, [this](RobotTime now) { step(now); });
}

void ScriptedSlave::reboot() {
  const auto set = [&](std::uint16_t index, std::uint8_t sub, std::uint32_t value, int bytes) {
    objects[std::uint32_t{index} << 8 | sub] = {value, bytes, true};
  };
  objects.clear();
  set(0x1000, 0, 0x00020192, 4);
  set(0x1016, 0, 2, 1);
  set(0x1016, 1, 0, 4);
  set(0x1016, 2, 0, 4);
  set(0x1017, 0, 0, 2);
  set(0x1029, 1, 1, 1);
  for (std::uint8_t sub = 1; sub <= 4; ++sub) set(0x1018, sub, 0x100u * sub, 4);
  for (std::uint16_t n = 0; n < 4; ++n)
    for (const std::uint16_t base : {0x1400, 0x1800}) {
      const std::uint16_t mapping = base + 0x200;
      set(base + n, 1, (base == 0x1400 ? 0x200u : 0x40000180u) + 0x100u * n + static_cast<std::uint32_t>(node), 4);
      set(base + n, 2, 255, 1);
      for (std::uint8_t sub = 0; sub <= 8; ++sub) set(mapping + n, sub, 0, sub == 0 ? 1 : 4);
    }
  for (const std::uint16_t index : {0x6007, 0x603F, 0x6040, 0x6041, 0x605A}) set(index, 0, 0, 2);
  for (const std::uint16_t index : {0x607F, 0x6080, 0x6081, 0x6083, 0x6084, 0x6085, 0x609A, 0x6064})
    set(index, 0, 0, 4);
  for (const std::uint8_t sub : {1, 2}) set(0x607D, sub, 0, 4), set(0x6099, sub, 0, 4), set(0x60C2, sub, 0, 1);
  for (const std::uint16_t index : {0x6060, 0x6061, 0x6098}) set(index, 0, 0, 1);
  set(0x6502, 0, 0x1a1, 4);
  nmt = 0x7f;
  state = 0x40;
  homed_ = false;
  commands.clear();
  send(0x700, {0});
}

void ScriptedSlave::remove(std::uint16_t index) {
  std::erase_if(objects, [index](const auto& item) { return item.first >> 8 == index; });
}

void ScriptedSlave::send(std::uint32_t function, std::vector<std::uint8_t> bytes) {
  CanFrame out;
  out.id = function + static_cast<std::uint32_t>(node);
  for (std::uint8_t b : bytes) out.data[out.size++] = b;
  if (!mute) end->send(out);
}

void ScriptedSlave::fail(std::uint16_t code) {
  state = 0x08;
  object(0x603F).value = code;
  send(0x080, {static_cast<std::uint8_t>(code), static_cast<std::uint8_t>(code >> 8), 1, 0, 0, 0, 0, 0});
}

void ScriptedSlave::answer_sdo(const CanFrame& r) {
  const std::uint32_t at = (std::uint32_t{r.data[2]} << 8 | r.data[1]) << 8 | r.data[3];
  const auto reply = [&](std::uint8_t command, std::uint32_t value) {
    send(0x580, {command, r.data[1], r.data[2], r.data[3], static_cast<std::uint8_t>(value),
                 static_cast<std::uint8_t>(value >> 8), static_cast<std::uint8_t>(value >> 16),
                 static_cast<std::uint8_t>(value >> 24)});
  };
  if (r.data[0] == 0x80) return;
  const auto found = objects.find(at);
  if (found == objects.end()) return reply(0x80, 0x06020000);
  Object& o = found->second;
  if (r.data[0] == 0x40) {
    if (at == 0x604100) o.value = status();
    if (at == 0x606400) o.value = static_cast<std::uint32_t>(position);
    // Unused bytes are full of garbage, as in real drives.
    const std::uint32_t garbage = o.bytes < 4 ? 0xAF8FBC5Au << (8 * o.bytes) : 0;
    return reply(static_cast<std::uint8_t>(0x43 | (4 - o.bytes) << 2), o.value | garbage);
  }
  const int bytes = 4 - (r.data[0] >> 2 & 3);
  if ((r.data[0] & 0xe3) != 0x23 || bytes != o.bytes) return reply(0x80, 0x06070010);
  std::uint32_t value = 0;
  for (int i = 0; i < bytes; ++i) value |= std::uint32_t{r.data[static_cast<std::size_t>(4 + i)]} << (8 * i);
  // A mapping is changed only while its PDO does not exist (CiA 301, 7.5.2.36).
  const std::uint32_t index = at >> 8;
  const bool mapping = (index & 0xff00) == 0x1600 || (index & 0xff00) == 0x1a00;
  if (mapping && !(objects[(index - 0x200) << 8 | 1].value & 0x80000000)) return reply(0x80, 0x06040041);
  const bool cob_id = ((index & 0xff00) == 0x1400 || (index & 0xff00) == 0x1800) && (at & 0xff) == 1;
  if (cob_id && !(o.value & 0x80000000) && (value ^ o.value) & 0x3fffffff) return reply(0x80, 0x06090030);
  writes.push_back(at);
  if (o.keeps) o.value = value;
  if (at == 0x606000 && o.keeps) objects[0x606100].value = value;
  if (at == 0x604000) apply({static_cast<std::uint16_t>(value), position});
  reply(0x60, 0);
}

std::uint16_t ScriptedSlave::status() const {
  int out = state | 0x0200;
  if (mode() == 6 && homed_) out |= 0x1400;
  if (mode() == 6 && homing_error_) out |= 0x2000;
  if (mode() == 8 && state == 0x27) out |= 0x1000;
  if (mode() == 1 && acknowledged_) out |= 0x1000;
  return static_cast<std::uint16_t>(out);
}

// The transitions by hand, from the drawing of the standard.
void ScriptedSlave::apply(Command c) {
  const bool edge7 = (c.word & 0x80) && !(last_word_ & 0x80), edge4 = (c.word & 0x10) && !(last_word_ & 0x10);
  const int low = c.word & 0x0f;
  last_word_ = c.word;
  if (state == 0x08) {
    if (edge7 && !stuck_fault) state = 0x40;
    return;
  }
  if (!(low & 2))
    state = 0x40;
  else if (!(low & 4))
    state = state == 0x27 || state == 0x07 ? 0x07 : 0x40;
  else if (state == 0x40 && (low & 7) == 6)
    state = 0x21;
  else if (state == 0x21 && (low & 7) == 7)
    state = 0x23;
  else if (state == 0x23 && (low & 7) == 6)
    state = 0x21;
  else if (state == 0x23 && low == 15)
    state = 0x27;
  else if (state == 0x07 && low == 15)
    state = 0x27;
  else if (state == 0x27 && low == 7)
    state = 0x23;
  else if (state == 0x27 && (low & 7) == 6)
    state = 0x21;
  if (state != 0x27) return;
  if (mode() == 8) position = c.target;
  if (mode() == 9) velocity = c.target;
  if (mode() == 1) {
    if (edge4) position = c.target, ++edges;
    acknowledged_ = (c.word & 0x10) != 0;
  }
  if (mode() == 6 && edge4) {
    homed_ = homing_error_ = false;
    homing_left_ = 20;
  }
}

void ScriptedSlave::sync() {
  ++syncs;
  if (has_waiting_) apply(waiting_);
  has_waiting_ = false;
  if (homing_left_ > 0 && --homing_left_ == 0) {
    homed_ = !homing_fails;
    homing_error_ = homing_fails;
    if (homed_) position = 0;
  }
  if (!sends_pdos) return;
  const std::uint16_t word = status();
  const auto byte = [](std::int64_t value, int i) { return static_cast<std::uint8_t>(value >> (8 * i)); };
  send(0x180,
       {byte(word, 0), byte(word, 1), byte(position, 0), byte(position, 1), byte(position, 2), byte(position, 3)});
  send(0x280, {byte(velocity, 0), byte(velocity, 1), byte(velocity, 2), byte(velocity, 3), byte(mode(), 0)});
}

void ScriptedSlave::step(RobotTime now) {
  while (const auto f = end->receive(0ms)) {
    if (mute) continue;
    if (f->id == 0x77f) ++heartbeats_heard;
    if (f->id == 0 && (f->data[1] == node || f->data[1] == 0)) nmt = f->data[0] == 1 ? 5 : f->data[0] == 2 ? 4 : 0x7f;
    if (f->id == 0x600u + static_cast<std::uint32_t>(node)) answer_sdo(*f);
    if (nmt != 5) continue;
    if (f->id == 0x200u + static_cast<std::uint32_t>(node) && f->size == 6) {
      waiting_.word = static_cast<std::uint16_t>(f->data[0] | f->data[1] << 8);
      waiting_.target = static_cast<std::int32_t>(std::uint32_t{f->data[2]} | std::uint32_t{f->data[3]} << 8 |
                                                  std::uint32_t{f->data[4]} << 16 | std::uint32_t{f->data[5]} << 24);
      commands.push_back(waiting_);
      has_waiting_ = true;
    }
    if (f->id == 0x80) sync();
  }
  const std::uint32_t period = objects[0x101700].value;
  if (period == 0 || now < next_heartbeat_) return;
  next_heartbeat_ = now + std::chrono::milliseconds(period);
  send(0x700, {nmt});
}

CanopenRig::CanopenRig(int drives, OperationMode m) : master(bus.attach()), stranger(bus.attach()), mode(m) {
  std::vector<Cia402Config> configs;
  for (int node = 1; node <= drives; ++node) {
    slaves.push_back(std::make_unique<ScriptedSlave>(bus, clock, node));
    configs.push_back(drive_config(node));
  }
  network = std::make_unique<CanopenNetwork>(*master, clock, config, configs);
}

Cia402Config CanopenRig::drive_config(int node) const {
  Cia402Config c;
  c.drive.name = "joint_" + std::to_string(node);
  c.drive.node = node;
  c.drive.counts_per_unit = 1000;
  c.drive.direction = node % 2 == 1 ? 1 : -1;
  c.drive.offset = 0.5;
  c.drive.min_position = -10;
  c.drive.max_position = 10;
  c.drive.max_velocity = 2;
  c.drive.max_acceleration = 5;
  c.mode = mode;
  c.homing_method = 1;
  return c;
}

void CanopenRig::configure() {
  for (Drive* drive : network->drives()) {
    drive->identify();
    drive->configure();
  }
}

void CanopenRig::cycles(int count, std::optional<double> position, double velocity) {
  for (int i = 0; i < count; ++i) {
    network->receive(clock.now());
    if (position)
      for (Drive* drive : network->drives()) drive->set_point(*position, velocity);
    network->send(clock.now());
    clock.sleep_until(clock.now() + config.cycle);
  }
  network->receive(clock.now());
}

void CanopenRig::enable() {
  for (Drive* drive : network->drives()) drive->request(DriveRequest::enable);
  cycles(15);
}

}  // namespace foresight::canopen
