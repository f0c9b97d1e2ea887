// Stands for pluginlib: its macro is this one of class_loader, which is the real one.
#pragma once

#include <class_loader/class_loader.hpp>

#define PLUGINLIB_EXPORT_CLASS(Derived, Base) CLASS_LOADER_REGISTER_CLASS(Derived, Base)
