# conan create cmake/packaging/conan. Never run: see ../README.md.
import os

from conan import ConanFile
from conan.tools.build import check_min_cppstd
from conan.tools.cmake import CMake, CMakeDeps, CMakeToolchain, cmake_layout
from conan.tools.files import copy


class Skinctl(ConanFile):
    name = "skinctl"
    version = "0.1.0"
    license = "BSD-3-Clause"
    description = "Header-only C++20 library: stiff robot arms give way where their skin is touched"
    package_type = "header-library"
    settings = "os", "compiler", "build_type", "arch"
    no_copy_source = True

    def export_sources(self):
        root = os.path.join(self.recipe_folder, "..", "..", "..")
        for part in ("CMakeLists.txt", "LICENSE", "cmake/*", "include/*"):
            copy(self, part, src=root, dst=self.export_sources_folder)

    def requirements(self):
        self.requires("eigen/[>=3.4.0 <6]")
        self.requires("boost/1.83.0", options={"header_only": True})

    def validate(self):
        check_min_cppstd(self, 20)

    def layout(self):
        cmake_layout(self)

    def generate(self):
        tools = CMakeToolchain(self)
        for part in ("TESTS", "EXAMPLES", "BENCHMARKS"):
            tools.variables[f"SKINCTL_BUILD_{part}"] = False
        tools.generate()
        CMakeDeps(self).generate()  # for find_package of Eigen and Boost in package()

    def package(self):
        CMake(self).configure()
        CMake(self).install()

    def package_id(self):
        self.info.clear()

    def package_info(self):
        self.cpp_info.bindirs = self.cpp_info.libdirs = []
        self.cpp_info.set_property("cmake_find_mode", "none")  # its own CMake package
        self.cpp_info.builddirs = [os.path.join("share", "cmake", "skinctl")]
