// Stands for hardware_interface: a state and a command of a joint, by name.
#pragma once

#include <string>

namespace hardware_interface {

class LoanedStateInterface {
 public:
  LoanedStateInterface(std::string name, const double* value) : name_(std::move(name)), value_(value) {}
  [[nodiscard]] const std::string& get_name() const { return name_; }
  [[nodiscard]] double get_value() const { return *value_; }

 private:
  std::string name_;
  const double* value_;
};

class LoanedCommandInterface {
 public:
  LoanedCommandInterface(std::string name, double* value) : name_(std::move(name)), value_(value) {}
  [[nodiscard]] const std::string& get_name() const { return name_; }
  bool set_value(double value) { return *value_ = value, true; }

 private:
  std::string name_;
  double* value_;
};

}  // namespace hardware_interface
