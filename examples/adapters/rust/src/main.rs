// A robot in memory behind missionfsm's adapter protocol: put your own in its place.
//
// cargo build --manifest-path examples/adapters/rust/Cargo.toml
// missionfsm conform bear.mission -- examples/adapters/rust/target/debug/adapter

use serde_json::{json, Value};
use std::collections::BTreeMap;
use std::io::{self, BufRead, Write};
use std::time::{SystemTime, UNIX_EPOCH};

const DESTINATIONS: [&str; 3] = ["kitchen", "table-1", "table-2"];
const ENDED: [&str; 2] = ["STATE_SUCCEEDED", "STATE_FAILED"];

/// A status and a message that a call is answered with.
type Refused = (&'static str, String);

#[derive(Default)]
struct Robot {
    missions: Vec<Value>,           // in their order
    streams: BTreeMap<u64, Value>,  // each stream, with what it was shown last
    stream_number: u64,             // none comes twice, not even after a reset
    sequence_number: u64,           // likewise
}

fn declared() -> Value {
    json!({
        "implementation": {"name": "starter in Rust", "version": "1"},
        "drives": ["goalReached", "missionFailed"],
        "methods": ["CreateMission", "AppendMission", "SubscribeMissionStatus"],
        "worlds": "fixed",
        "world": {"family": "base", "destinations": DESTINATIONS},
        "requests": "binary", // nothing of a wrong type is sent: your gRPC library would not let it in either
    })
}

fn code(status: &str) -> i32 {
    match status {
        "INVALID_ARGUMENT" => 3,
        "FAILED_PRECONDITION" => 9,
        _ => -32601, // there is no such method
    }
}

fn is_goal(goal: &Value) -> bool {
    match goal["pose"].as_object() {
        Some(pose) => pose.values().all(Value::is_number), // NaN and the infinities are texts
        None => DESTINATIONS.iter().any(|name| goal["destinationId"] == *name),
    }
}

/// The type and the goals of a base mission, if that is what is asked for and its goals are on the map.
fn wanted(request: &Value) -> Option<(&str, Vec<Value>)> {
    let base = &request["mission"]["baseMission"];
    let (kind, goals) = match base["navigateAutoMission"]["goals"].as_array() {
        Some(goals) => ("BASE_TYPE_NAVIGATE_AUTO", goals.clone()),
        None => ("BASE_TYPE_NAVIGATE", vec![base["navigateMission"]["goal"].clone()]),
    };
    (!goals.is_empty() && goals.iter().all(is_goal)).then_some((kind, goals))
}

impl Robot {
    /// Where the mission that runs is: the first that has not ended.
    fn current(&self) -> Option<usize> {
        self.missions.iter().position(|one| !ENDED.iter().any(|state| one["state"] == *state))
    }

    fn assign(&mut self, request: &Value, first: bool) -> Result<Value, Refused> {
        let Some((kind, goals)) = wanted(request) else {
            return Err(("INVALID_ARGUMENT", "what is needed is a base mission, with goals that are on the map".into()));
        };
        if first && self.current().is_some() {
            return Err(("FAILED_PRECONDITION", "a mission is running or waiting".into()));
        }
        if !first && self.missions.is_empty() {
            return Err(("FAILED_PRECONDITION", "there is no mission to append to".into()));
        }
        let name = format!("mission-{}", self.missions.len() + 1);
        let kind = json!({"baseType": kind});
        self.missions.push(json!({"missionId": name, "state": "STATE_DEFAULT", "goals": goals, "missionType": kind}));
        Ok(json!({"missionId": name}))
    }

    fn answer(&mut self, method: &str, params: &Value) -> Result<Value, Refused> {
        match method {
            "initialize" => return Ok(declared()),
            "CreateMission" | "AppendMission" => return self.assign(params, method == "CreateMission"),
            "SubscribeMissionStatus" => {
                self.stream_number += 1;
                self.streams.insert(self.stream_number, Value::Null);
                return Ok(json!({"stream": self.stream_number}));
            }
            "drive" => {
                let current = self.current();
                if let Some(index) = current {
                    self.missions[index]["state"] = json!(ENDED[usize::from(params["event"] == "missionFailed")]);
                }
                return Ok(json!({"happened": current.is_some()}));
            }
            "reset" => (self.missions, self.streams) = Default::default(),
            "cancel" => {
                self.streams.remove(&params["stream"].as_u64().unwrap_or(0));
            }
            "settle" => {} // nothing is under way: what was caused has been written
            _ => return Err(("METHOD_NOT_FOUND", format!("there is no {method}"))),
        }
        Ok(json!({}))
    }

    /// Whatever happened: what is next starts, and every stream that was not shown how things are is shown it.
    fn show(&mut self) {
        let current = self.current();
        if let Some(index) = current {
            self.missions[index]["state"] = json!("STATE_RUNNING");
        }
        let index = current.map_or(-1, |index| index as i64);
        let states = json!({"missions": self.missions, "currentMissionIndex": index});
        for (stream, shown) in &mut self.streams {
            if *shown != states {
                *shown = states.clone();
                self.sequence_number += 1;
                let seconds = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs());
                let metadata = json!({"timestamp": {"seconds": seconds}, "sequenceNumber": self.sequence_number});
                let message = json!({"metadata": metadata, "missionStates": states});
                write(json!({"jsonrpc": "2.0", "method": "message", "params": {"stream": stream, "message": message}}));
            }
        }
    }
}

/// Write a line, and flush: nothing may be held back.
fn write(line: Value) {
    let mut out = io::stdout().lock();
    writeln!(out, "{line}").and_then(|()| out.flush()).expect("the tester is gone");
}

fn main() {
    let mut robot = Robot::default();
    for line in io::stdin().lock().lines() {
        let asked: Value = serde_json::from_str(&line.expect("UTF-8")).expect("JSON");
        let (id, method) = (&asked["id"], asked["method"].as_str().unwrap_or(""));
        write(match robot.answer(method, &asked["params"]) {
            Ok(result) => json!({"jsonrpc": "2.0", "id": id, "result": result}),
            Err((status, message)) => json!({"jsonrpc": "2.0", "id": id, "error": {
                "code": code(status), "message": message, "data": {"status": status}}}),
        });
        robot.show();
    }
}
