# Long forms of tests whose size is an environment variable. Each is a test NAME_long with the label nightly, unless this build
# leaves its program out.
set(long_forms
  # name, program, most seconds, variables (comma between two), filter
  "unit/elections       unit_fleet_tests     3600 COLLIDED_ELECTIONS=20000 LeadershipInRandomOrder.*"
  # Twelve million triangles.
  "unit/tile_memory     memory_tests         3600 COLLIDED_CELLS=2450 TileMemory.*"
  "unit/moving_sweeps   unit_exact_tests     7200 COLLIDED_SWEEPS=1000000 ExactMovingTwin.SamplingFindsNoContactBeforeTheFirst"
  "unit/body_sweeps     unit_exact_tests    14400 COLLIDED_SWEEPS=200000 ExactBodyMotion.TenThousandPosesOfAWayShowNoContactBeforeTheFirst"
  "unit/half_spaces     unit_exact_tests     7200 COLLIDED_HALF_SPACES=25000 *HalfSpaces.EveryKindIsDecidedAsByRationals*"
  # 10,000 tangents and more of every pair of kinds with a round solid.
  "unit/tangents        unit_exact_tests     7200 COLLIDED_TANGENTS=17 ExactRoundTangents.*"
  "unit/depths          unit_exact_tests     7200 COLLIDED_DEPTHS=14000 *ExactDepth.PartsThePairAndNothingShorterDoes*"
  "unit/damage          unit_service_tests   3600 COLLIDED_DAMAGE_ROUNDS=10000 DurableStateTest.NoDamageIsSilent:EpochFile.NoSingleDamageIsBelieved"
  "unit/seam_rays       unit_intake_tests    3600 COLLIDED_SEAM_RAYS=1000000 IntakeMend.CracksBetweenTwoTessellationsLeakAndMendedTheyDoNot"
  "unit/levels          unit_world_tests     7200 COLLIDED_LEVELS=100000 WorldLevels.DistancesHoldTheirBoundAndReachIsExact"
  "unit/pair_poses      unit_exact_tests     7200 COLLIDED_POSES=1000000 ExactPairPoses.*"
  "extreme/given        extreme_world_tests  7200 COLLIDED_PAIRS=30000 ExtremeGiven*.APairIs*"
  "extreme/placed       extreme_world_tests  7200 COLLIDED_PAIRS=100000 ExtremePlacedPairs.*"
  "unit/implicit_sphere unit_exact_tests     3600 COLLIDED_IMPLICIT_POINTS=1000000 ExactImplicitSphere.TheSignOfFIsThatOfRationals"
  "unit/implicit_rays   unit_exact_tests     7200 COLLIDED_IMPLICIT_RAYS=2000 *ExactImplicitRay*"
  # A million points of every kind, on fifteen meshes.
  "unit/solids          unit_world_tests    14400 COLLIDED_SOLID_POINTS=60000 WorldSolid.Sides*:WorldSolid.Where*:WorldSolid.WhatIs*"
  "unit/solid_trees     unit_exact_tests     7200 COLLIDED_SOLID_SEGMENTS=2000,COLLIDED_SOLID_POLYTOPES=3000,COLLIDED_SOLID_EYES=200 ExactSolid*.*Rationals:ExactFaceOrder.IsThat*"
  "unit/windings        unit_exact_tests     7200 COLLIDED_WINDING_POINTS=20000 ExactWinding*"
  "unit/crossings       unit_world_tests    14400 COLLIDED_CROSSINGS=1000000 WorldCommonTime.GeneratedCrossings*:WorldCommonTime.WhatIsLeftOut*"
  "unit/fences          unit_world_tests    14400 COLLIDED_FENCES=1000000 FenceCrossings.AreReportedAsTheOracleFindsThem"
  "unit/margins         unit_world_tests    14400 COLLIDED_MARGINS=100000 MarginCrossings.AreReportedAsTheOracleFindsThem"
  "unit/nearest         unit_world_tests    14400 COLLIDED_NEAREST=20000 NearestCrossings.AreReportedAsTheOracleFindsThem"
  "unit/cut_ways        unit_world_tests    14400 COLLIDED_WAYS=100000 WorldCutWays.*"
  "unit/sampled_ways    unit_world_tests     7200 COLLIDED_SAMPLED=2000 PieceIntervalsSampled.*"
  "unit/arrival_orders  unit_world_tests     3600 COLLIDED_ORDERS=1000 WorldCommonTime.AnyArrivalOrder*"
  "model/world          model_tests          3600 COLLIDED_TWIN_STEPS=6000 WorldTwin.*"
  "model/publishers     model_tests          3600 COLLIDED_TWIN_OPERATIONS=1000000 PublishersTwin.*"
  "model/journal        model_tests          3600 COLLIDED_TWIN_ROUNDS=100000 JournalTwin.*"
  "model/server         model_tests          3600 COLLIDED_SERVER_TWIN_ROUNDS=3000 ServerTwin.*"
  "model/client         model_tests          3600 COLLIDED_TWIN_ROUNDS=100000 RepliesTwin.*:WatchTwin.*"
  "homework/pairs       homework_tests       1200 COLLIDED_FRAMES=10000 HomeworkEvents.*"
  # 1e7 answers of each kind, in four families.
  "accuracy/bounds      accuracy_tests      14400 COLLIDED_CASES=600000 *"
)
foreach(form IN LISTS long_forms)
  separate_arguments(form UNIX_COMMAND "${form}")
  list(GET form 0 name)
  list(GET form 1 program)
  list(GET form 2 timeout)
  list(GET form 3 variables)
  list(GET form 4 filter)
  if(TARGET ${program})
    string(REPLACE "," ";" variables ${variables})
    add_test(NAME ${name}_long COMMAND ${program} --gtest_filter=${filter})
    set_tests_properties(${name}_long PROPERTIES LABELS nightly TIMEOUT ${timeout} ENVIRONMENT "${variables}"
      # A filter that names no test any more would pass for ever.
      FAIL_REGULAR_EXPRESSION "Running 0 tests from 0 test suites")
  endif()
endforeach()
