// Short names for the types that are generated from the service's OpenAPI document.

import type { components } from "./schema";

type Schemas = components["schemas"];
export type Status = Schemas["Status"];
export type Alarm = Schemas["Alarm"];
export type Camera = Schemas["CameraReport"];
export type Adaptation = Schemas["Adaptation"];
export type Client = Schemas["ClientReport"];
export type Clients = Schemas["Clients"];
export type Waiting = Schemas["WaitingReport"];
export type Field = Schemas["Field"];
export type EdgeType = Schemas["EdgeTypeReport"];
export type Task = Schemas["TaskReport"];
export type Timing = Schemas["Timing"];
export type Fairness = Schemas["FairnessReport"];
export type TeamFairness = Schemas["TeamFairness"];
export type KeptReport = Schemas["KeptReport"];
export type LogLine = Schemas["LogLineReport"];
export type Log = Schemas["LogReport"];
export type Histogram = Schemas["Histogram"];
export type Team = Schemas["TeamReport"];
export type TeamRequest = Schemas["TeamRequest"];
export type Monitors = Schemas["MonitorsReport"];
export type Match = Schemas["MatchReport"];
export type Game = Schemas["GameReport"];
export type Setting = Schemas["SettingReport"];
export type Settings = Schemas["SettingsReport"];
export type Sources = Schemas["SourcesReport"];
export type Change = Schemas["ChangeReport"];
export type Exported = Schemas["Export"];
export type Calibration = Schemas["CalibrationReport"];
export type CalibrationPicture = Schemas["CalibrationPictureReport"];
export type FittedMirror = Schemas["MirrorResult"];
export type MirrorPairs = Schemas["PairsReport"];
export type FoundPair = Schemas["FoundPairReport"];
export type MirrorEdge = Schemas["EdgeReport"];
export type MirrorRim = Schemas["RimReport"];
export type Mirrors = Schemas["MirrorsReport"];
export type MirrorInForce = Schemas["MirrorInForce"];
export type MirrorPreview = Schemas["MirrorPreview"];
export type PaintedLine = Schemas["LineReport"];
export type NewVenue = Schemas["NewVenueReport"];
export type VenuePatch = Schemas["DraftPatch"];
export type VenueChoices = Schemas["ChoicesReport"];
export type PatternChoice = Schemas["PatternChoice"];
export type FieldMeasures = Schemas["FieldMeasures"];
export type FieldTrial = Schemas["FieldTrialReport"];
export type CameraTrial = Schemas["CameraTrialReport"];
export type PictureTrial = Schemas["PictureTrialReport"];
export type VenueTrial = Schemas["VenueTrialReport"];
export type Sampled = Schemas["SampledReport"];
export type ColorClasses = Schemas["ClassesReport"];
export type Difference = Schemas["DifferenceReport"];
export type Saved = Schemas["SavedReport"];
export type Me = Schemas["Me"];
/** Why a request failed (RFC 9457). */
type Details = Schemas["ProblemDetails"];
export type Problem = Pick<Details, "type" | "title" | "status" | "detail" | "instance"> & Partial<Details>;
export type Color = "blue" | "yellow";
export const COLORS: readonly Color[] = ["blue", "yellow"];

/** A robot that a program can have. */
export interface Robot {
  team: Color;
  number: number;
}

export const isSame = (one: Robot | null, other: Robot | null): boolean =>
  one !== null && other !== null && one.team === other.team && one.number === other.number;
