#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "error_text.h"
#include "rigproof/calib/diagnose/ml_settings.h"
#include "temp_folder.h"

namespace rigproof {
namespace {

using testing::AllOf;
using testing::HasSubstr;

TEST(MlSettings, AreReadFromTheMethodsName) {
  const MlSettings settings = read_ml_settings("clock_offset_sigma_ms=5,focal_sigma_percent=0.4,name=ml_lens");
  EXPECT_EQ(settings.name, "ml_lens");
  const MlOptions options = settings.options();
  EXPECT_DOUBLE_EQ(options.priors.clock_offset_s, 0.005);
  EXPECT_DOUBLE_EQ(options.priors.focal_relative, 0.004);
  EXPECT_DOUBLE_EQ(options.priors.principal_point_px, 0.0);
  EXPECT_DOUBLE_EQ(options.priors.rotation_centre_m, MlOptions().priors.rotation_centre_m);
  EXPECT_EQ(MlMethod(settings).traits().name, "ml_lens");
}

// A result lies under its method's name: one with settings must not replace that of ml as it is.
TEST(MlSettings, NameTheMethodUnlessItIsNamed) {
  const auto name = [](const std::string& text) { return read_ml_settings(text).name; };
  EXPECT_EQ(name("told=exact"), "ml-told_exact");
  EXPECT_EQ(name("told=exact,focal_sigma_percent=0.40"), "ml-focal_sigma_percent_0.4-told_exact");
  EXPECT_EQ(name("focal_sigma_percent=0.4,told=exact"), name("told=exact,focal_sigma_percent=0.4"));
  EXPECT_EQ(name("told=as_stated"), "ml") << "the usual setting";
  EXPECT_EQ(name("turn_lag_sigma_ms=20"), "ml-turn_lag_sigma_ms_20") << "usual, and it wins over the rig";
  EXPECT_EQ(name("told=exact,name=ml"), "ml");
}

TEST(MlSettings, AreReadFromAFileWhoseNameTheyTake) {
  const TempFolder folder;
  const std::filesystem::path file =
      folder.write("my_lens.yaml", "principal_point_sigma_px: 2\nrotation_centre_sigma_mm: 0\n");
  const MlSettings settings = read_ml_settings(file.string());
  EXPECT_EQ(settings.name, "my_lens");
  EXPECT_DOUBLE_EQ(settings.options().priors.principal_point_px, 2.0);
  EXPECT_DOUBLE_EQ(settings.options().priors.rotation_centre_m, 0.0);
}

// What was asked for wins over the rig, also where it is the usual value.
TEST(MlSettings, KnowWhatWasAskedFor) {
  OdometryNoise rig;
  rig.turn_lag_sigma_s = 0.001;
  rig.veer_sigma_rad_per_m = 0.001;
  const PriorSigmas asked = read_ml_settings("turn_lag_sigma_ms=20,odometry_scale_sigma_percent=3").options().priors;
  EXPECT_DOUBLE_EQ(asked.odometry_scale, 0.03);
  EXPECT_EQ(with_those_of_rig(asked, rig).turn_lag_s, 0.02);
  EXPECT_EQ(with_those_of_rig(asked, rig).odometry_veer_rad_per_m, 0.001) << "nobody asked";
  EXPECT_NE(MlMethod(read_ml_settings("turn_lag_sigma_ms=20")).settings_text(), MlMethod().settings_text());
}

TEST(MlSettings, AreRefusedWithEveryProblemAtOnce) {
  EXPECT_THAT(error_text([] { read_ml_settings("focal_sigma_percent=-1,clock_offset_ms=5"); }),
              AllOf(HasSubstr("focal_sigma_percent"), HasSubstr("-1"), HasSubstr("clock_offset_sigma_ms")));
  EXPECT_THAT(error_text([] { read_ml_settings("focal_sigma_percent=much"); }), HasSubstr("much"));
  EXPECT_THAT(error_text([] { read_ml_settings("focal_sigma_percent=1,2"); }), HasSubstr("KEY=VALUE"));
  for (const char* key :
       {"clock_offset_sigma_ms", "focal_sigma_percent", "principal_point_sigma_px", "turn_lag_sigma_ms"}) {
    EXPECT_THAT(error_text([key] { read_ml_settings(std::string(key) + "=1e-300"); }),
                AllOf(HasSubstr(key), HasSubstr("1e-300"), HasSubstr("allowed is 0 (believed) or 0.001 and more")));
    EXPECT_EQ(error_text([key] { read_ml_settings(std::string(key) + "=0"); }), "");
    EXPECT_EQ(error_text([key] { read_ml_settings(std::string(key) + "=0.001"); }), "");
  }
  EXPECT_THAT(error_text([] { read_ml_settings("name=../x"); }), HasSubstr("letters, digits"));
  EXPECT_THAT(error_text([] { read_ml_settings("nothing.yaml"); }), HasSubstr("nothing.yaml"));
  EXPECT_THAT(error_text([] { read_ml_settings(""); }), HasSubstr("KEY=VALUE"));
}

TEST(MlSettings, OtherValuesAreAnotherMethod) {
  EXPECT_NE(MlMethod(read_ml_settings("focal_sigma_percent=1")).settings_text(),
            MlMethod(read_ml_settings("focal_sigma_percent=2")).settings_text());
}

}  // namespace
}  // namespace rigproof
