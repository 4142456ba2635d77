use linkage_fmu::simulation::Simulation;
use serde_json::{json, Value};
fn rod(l: f64, m: f64) -> Value { json!({"length": l, "mass": m, "shape": "uniform_rod"}) }
fn pin(a: &str, b: &str) -> Value { json!({"type":"revolute","first":a,"second":b}) }
fn scissor(n: usize, l: f64, mass: f64, phi: f64) -> String {
    let mut bodies = json!({"ground": {"length": 1.0}, "carriage": {"mass": mass, "inertia": 0.01, "length": 0.1}});
    let mut joints = json!({"rail": {"type":"prismatic","first":"ground.origin","second":"carriage.origin","axis_angle":0.0}});
    let mut guess = json!({"rail": l * phi.cos()});
    for k in 1..=n {
        let mut b = rod(l, mass); b["points"] = json!({"mid": [0.5*l, 0.0]});
        bodies[format!("a{k}")] = b.clone(); bodies[format!("b{k}")] = b;
        guess[format!("a{k}")] = json!(phi); guess[format!("b{k}")] = json!(std::f64::consts::PI - phi);
        joints[format!("mid{k}")] = pin(&format!("a{k}.mid"), &format!("b{k}.mid"));
        if k == 1 {
            joints["left1"] = pin("ground.origin", "a1.origin");
            joints["right1"] = pin("carriage.origin", "b1.origin");
        } else {
            joints[format!("left{k}")] = pin(&format!("b{}.end", k-1), &format!("a{k}.origin"));
            joints[format!("right{k}")] = pin(&format!("a{}.end", k-1), &format!("b{k}.origin"));
        }
    }
    json!({"name":"Scissor","gravity":{"acceleration":9.81,"up_angle":std::f64::consts::FRAC_PI_2},
      "bodies":bodies,"joints":joints,"torques":{"drive":{"on":"a1"}},
      "start":{"body":"a1","angle":phi,"speed":0.0},"guess":guess}).to_string()
}
fn peaucellier(m: f64) -> String {
    let (a, l, s) = (0.5, 1.5, 0.6f64);
    // O at origin, A at (a,0), crank at angle 0.6 about A
    let t: f64 = 0.5;
    let (bx, by) = (a + a*t.cos(), a*t.sin());
    let ob = bx.hypot(by); let dir = by.atan2(bx);
    // C: distance l from O, s from B
    let c = ((l*l + ob*ob - s*s)/(2.0*l*ob)).acos();
    let (ac, ad) = (dir + c, dir - c);
    let pt = |ang: f64| (l*ang.cos(), l*ang.sin());
    let (cx, cy) = pt(ac); let (dx, dy) = pt(ad);
    let op = (l*l - s*s)/ob; let (px, py) = (op*dir.cos(), op*dir.sin());
    let angle = |x0: f64, y0: f64, x1: f64, y1: f64| (y1-y0).atan2(x1-x0);
    let mut cp = rod(s, 1.0); cp["mass"] = json!(m);
    json!({"name":"Peaucellier","gravity":{"acceleration":9.81,"up_angle":std::f64::consts::FRAC_PI_2},
     "bodies":{"ground":{"length":a},"crank":rod(a,1.0),"oc":rod(l,1.0),"od":rod(l,1.0),"cb":rod(s,1.0),"db":rod(s,1.0),"cp":cp,"dp":rod(s,1.0)},
     "joints":{"A":pin("ground.end","crank.origin"),"O1":pin("ground.origin","oc.origin"),"O2":pin("ground.origin","od.origin"),
       "C1":pin("oc.end","cb.origin"),"C2":pin("oc.end","cp.origin"),"D1":pin("od.end","db.origin"),"D2":pin("od.end","dp.origin"),
       "B1":pin("crank.end","cb.end"),"B2":pin("crank.end","db.end"),"P":pin("cp.end","dp.end")},
     "torques":{"drive":{"on":"crank"}},
     "start":{"body":"crank","angle":t,"speed":0.0},
     "guess":{"crank":t,"oc":ac,"od":ad,"cb":angle(cx,cy,bx,by),"db":angle(dx,dy,bx,by),"cp":angle(cx,cy,px,py),"dp":angle(dx,dy,px,py)}}).to_string()
}
fn hart() -> String {
    // Hart's inversor: antiparallelogram ABCD, AB=CD=long, BC=DA=short; points O on AB, P on BC? , Q on AD, collinear parallel to AC.
    let (long, short): (f64, f64) = (2.0, 1.0);
    let (x, h): (f64, f64) = (0.4, 0.5); // fraction on sides
    let _ = h;
    // Antiparallelogram with A=(0,0), C=(d,0): diag AC parallel BD. AB=long,CD=long crossing; AD=BC=short.
    let d: f64 = 1.9; // AC
    // BD = (long^2-short^2)/d
    let bd = (long*long - short*short)/d;
    // B=(xb,y), D=(xb-bd?,y): AB=long: xb^2+y^2=long^2 ; CD=long: (xd-d)^2+y^2=long^2 -> xd=d-xb ; BD=|2xb-d|=bd -> xb=(d+bd)/2
    let xb = 0.5*(d+bd); let y = (long*long-xb*xb).sqrt(); let xd = d - xb;
    let at = |p:(f64,f64),q:(f64,f64),f:f64| (p.0+(q.0-p.0)*f, p.1+(q.1-p.1)*f);
    let (a,b,c,dd) = ((0.0,0.0),(xb,y),(d,0.0),(xd,y));
    let o = at(a,b,x); let p = at(a,dd,x); let _q = at(c,b,x);
    // shift so that O is ground origin; P driven by crank through O: crank centre E at distance r from O, P on circle
    let ang = |p:(f64,f64),q:(f64,f64)| (q.1-p.1).atan2(q.0-p.0);
    let op = (p.0-o.0, p.1-o.1);
    let r = 0.45; // radius; E = at distance r from O and r from P
    let hop = op.0.hypot(op.1); let dir = op.1.atan2(op.0);
    let e_dir = dir + (hop/(2.0*r)).acos(); let e = (r*e_dir.cos(), r*e_dir.sin());
    let crank = ang(e, op);
    let body = |l: f64| { let mut b = rod(l, 1.0); b["points"] = json!({"x":[x*l,0.0]}); b };
    json!({"name":"Hart","gravity":{"acceleration":9.81,"up_angle":std::f64::consts::FRAC_PI_2},
     "bodies":{"ground":{"points":{"e":[e.0,e.1]}},"crank":rod(r,1.0),"ab":body(long),"ad":body(short),"cb":body(short),"cd":body(long)},
     "joints":{"E":pin("ground.e","crank.origin"),"O":pin("ground.origin","ab.x"),"P":pin("crank.end","ad.x"),
       "A":pin("ab.origin","ad.origin"),"B":pin("ab.end","cb.end"),"C":pin("cb.origin","cd.origin"),"D":pin("cd.end","ad.end")},
     "torques":{"drive":{"on":"crank"}},
     "start":{"body":"crank","angle":crank,"speed":0.0},
     "guess":{"crank":crank,"ab":ang(a,b),"ad":ang(a,dd),"cb":ang(c,b),"cd":ang(c,dd)}}).to_string()
}
fn main() {
    let try_one = |name: String, text: String| {
        let t = std::time::Instant::now();
        let r = Simulation::open(&text).and_then(|mut s| { s.initialize()?; Ok(s) });
        match r { Ok(mut s) => {
            let mut worst: f64 = 0.0; let mut most: f64 = 0.0;
            for _ in 0..200 { if let Err(e) = s.step(0.02) { println!("{name}: step {e}"); break; }
              worst = worst.max(s.get("energy.drift").unwrap().abs()); most = most.max(s.get("energy.kinetic").unwrap()); }
            println!("{name}: ok {:?} drift {worst:.1e} of {most:.1e}", t.elapsed()); }
          Err(e) => println!("{name}: {e}") }
    };
    for n in [1,2,3,4,5,10,20,40,80] { try_one(format!("scissor {n}"), scissor(n, 1.2, 1.0, 0.7)); }
    for m in [0.05,0.1,0.2,0.3,0.4,0.45,0.5,1.0,2.0,5.0,10.0] { try_one(format!("peaucellier {m}"), peaucellier(m)); }
    try_one("hart".into(), hart());
    for k in 1..6 { try_one(format!("scissor 10 mass {k}"), scissor(10, 1.2, k as f64 * 0.3, 0.3 * k as f64 - 0.2)); }
}
