// A cluster's nodes differ in their processors; the bytes that they make must not.
#include <gmock/gmock.h>

#include <regex>
#include <set>

#include "support/program.hpp"

namespace tubebin::testing {
namespace {

constexpr const char* kQemu = "/usr/bin/qemu-x86_64";

/// Every effect of a scanner, on quick scenes.
std::string quick_effects_config() {
  return "include: " TUBEBIN_SOURCE_DIR
         "/config/scanner_zivid_like.yaml\n"
         "seed: 5\ntubes: [3]\ncases: 300\n"
         "tube: {length: 0.2, cylinder_count_max: 6}\n"
         "scanner: {width: 320, height: 200}\n";
}

class OtherProcessors : public ::testing::Test {
 protected:
  OtherProcessors() { write_text(config_, quick_effects_config()); }

  /// The scenes' files as `prefix` lets the program make them.
  std::map<std::string, std::string> generate(std::vector<std::string> prefix, const std::string& cases) {
    const std::string output = folder_ / "of_" + std::to_string(++outputs_);
    for (const std::string& argument :
         {program_path("generate_dataset"), config_, std::string("--output"), output, std::string("--cases"), cases,
          std::string("--jobs"), std::string("2"), std::string("--quiet")})
      prefix.push_back(argument);
    const ProgramResult made = Program(prefix).wait();
    EXPECT_EQ(made.exit_code, 0) << made.error;
    return scene_files(output);
  }

  static void expect_same(const std::map<std::string, std::string>& files,
                          const std::map<std::string, std::string>& others) {
    EXPECT_EQ(files.size(), others.size());
    for (const auto& [name, bytes] : files) EXPECT_TRUE(others.contains(name) && others.at(name) == bytes) << name;
  }

  TemporaryFolder folder_;
  std::string config_ = folder_ / "quick.yaml";
  int outputs_ = 0;
};

// glibc 2.33 and later name what a processor has as here, earlier ones with _Usable.
TEST_F(OtherProcessors, MakeTheSameBytesWithoutFusedMultiplyAdds) {
  const auto files = generate({"/usr/bin/env"}, "300");
  EXPECT_EQ(files.size(), 1200u);
  expect_same(generate({"/usr/bin/env",
                        "GLIBC_TUNABLES=glibc.cpu.hwcaps=-FMA,-FMA4,-AVX2,-FMA_Usable,"
                        "-FMA4_Usable,-AVX2_Usable"},
                       "300"),
              files);
}

// The emulated processor also turns Embree and our own vector code to what they have for it.
TEST_F(OtherProcessors, MakeTheSameBytesWithoutAnyVectorsBeyondSse4) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "qemu cannot run sanitized programs";
#endif
  if (!fs::exists(kQemu)) GTEST_SKIP() << kQemu << " is missing (Debian: qemu-user)";
  expect_same(generate({kQemu, "-cpu", "Nehalem"}, "2"), generate({"/usr/bin/env"}, "2"));
}

// Whoever calls a further function adds it to src/core/portable_math.cpp, unless it is exact as these are.
TEST_F(OtherProcessors, NoProgramTakesFromTheMathLibraryButExactFunctions) {
  const std::regex import(R"(F \*UND\*\s+0+ \(GLIBC_[\d.]+\)\s+(\w+))");
  const std::set<std::string> math = {"acos",   "acosh",  "asin", "asinh", "atan",  "atan2", "atanh", "cbrt",
                                      "cos",    "cosh",   "erf",  "erfc",  "exp",   "exp10", "exp2",  "expm1",
                                      "hypot",  "lgamma", "log",  "log10", "log1p", "log2",  "pow",   "sin",
                                      "sincos", "sinh",   "tan",  "tanh",  "tgamma"};
  for (const std::string app : {"generate_dataset", "model_tubes", "evaluate", "export_dataset", "calibrate_modeler"}) {
    const ProgramResult symbols = Program({"/usr/bin/objdump", "-T", program_path(app)}).wait();
    ASSERT_EQ(symbols.exit_code, 0) << symbols.error;
    int imports = 0;
    for (std::sregex_iterator at(symbols.out.begin(), symbols.out.end(), import), end; at != end; ++at, ++imports) {
      std::string name = (*at)[1];
      EXPECT_FALSE(math.contains(name)) << app << " imports " << name;
      if (name.ends_with('f')) name.pop_back();
      EXPECT_FALSE(math.contains(name)) << app << " imports " << name << "f";
    }
    EXPECT_GT(imports, 50) << app;
  }
}

}  // namespace
}  // namespace tubebin::testing
