#include "tubebin/jobs/line_journal.hpp"

#include <gmock/gmock.h>

#include "support/program.hpp"
#include "tubebin/core/error.hpp"

namespace tubebin::jobs {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;

class LineJournalTest : public ::testing::Test {
 protected:
  testing::TemporaryFolder folder_;
  std::string path_ = folder_ / "runs.jsonl";
};

TEST_F(LineJournalTest, GrowsByWholeLines) {
  LineJournal(OutputFolder(folder_ / ""), "runs.jsonl").append("a");
  LineJournal(OutputFolder(folder_ / ""), "runs.jsonl").append("b");
  testing::write_text(path_, testing::read_text(path_) + "cut sho");
  LineJournal journal(OutputFolder(folder_ / ""), "runs.jsonl");
  EXPECT_THAT(journal.lines(), ElementsAre("a", "b"));
  journal.append("c");
  EXPECT_EQ(testing::read_text(path_), "a\nb\nc\n");
}

TEST_F(LineJournalTest, DoesNotGoOnInAFileThatWasRemovedOrCut) {
  LineJournal journal(OutputFolder(folder_ / ""), "runs.jsonl");
  journal.append("a first line");
  testing::write_text(path_, "a");
  EXPECT_THROW(journal.append("b"), IoError);
  EXPECT_EQ(testing::read_text(path_), "a") << "no zeros between what is left and the new line";
  fs::remove(path_);
  EXPECT_THROW(journal.append("b"), IoError);
  EXPECT_FALSE(fs::exists(path_));
}

}  // namespace
}  // namespace tubebin::jobs
