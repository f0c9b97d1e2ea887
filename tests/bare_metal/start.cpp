// What a Cortex-M7 needs before newlib's start-up code: a vector table, and the floating-point unit switched
// on.
#include <cstdint>

extern "C" {
extern std::uint32_t stack_top;
void _start();

void reset() {
  *reinterpret_cast<volatile std::uint32_t*>(0xE000ED88) |= 0xFu << 20;  // CPACR: full access to CP10, CP11
  asm volatile("dsb\n isb");
  _start();
  while (true) {
  }
}
/// newlib asks for it when libstdc++ is linked; nothing here draws random numbers.
int getentropy(void*, unsigned) {
  return -1;
}
/// A fault ends the emulation as a failure: semihosting's SYS_EXIT with "run-time error".
void fault() {
  asm volatile("mov r0, #0x18\n movw r1, #0x23\n movt r1, #2\n bkpt 0xAB");
  while (true) {
  }
}
}

__attribute__((section(".vectors"), used)) const std::uintptr_t vectors[16] = {
    reinterpret_cast<std::uintptr_t>(&stack_top), reinterpret_cast<std::uintptr_t>(&reset),
    reinterpret_cast<std::uintptr_t>(&fault),     reinterpret_cast<std::uintptr_t>(&fault),
    reinterpret_cast<std::uintptr_t>(&fault),     reinterpret_cast<std::uintptr_t>(&fault),
    reinterpret_cast<std::uintptr_t>(&fault)};
