#![allow(clippy::all, missing_docs)]
use pliant::study::{column::*, drive::*, measure::*, skill::*, world::*};
fn main() {
    let lasa = std::env::args().nth(1).map(std::path::PathBuf::from);
    let skills = Skills::new(lasa.as_deref(), &|_| {}).unwrap();
    let own = Skills::new(None, &|_| {}).unwrap();
    let d=Driving::of(Robot::Lagging);
    let go=|s:&Skill,c:f64,b:Vec<Body>,layers:u8| -> f64 {
        let w=World::new(s,b); let mut sp=vec![];
        for col in [Column::Pliant, Column::Original] {
            match pliant::scene::Scene::parse_with_model("x",&w.toml(col).replace("c = 0.05",&format!("c = {c:?}")),&s.text) {
                Ok(sc)=>{ let r=drive(&sc,&s.start,&d,None).unwrap(); if !r.reached||r.touched() {return f64::NAN} sp.push(mean_speed(&r,|s|s.layers==layers&&s.gamma>1.0).unwrap_or(f64::NAN)) }
                Err(_)=>return f64::NAN } }
        change_percent(sp[0],sp[1]) };
    let _=go;
    for (nm,sk) in [("lasa",&skills),("own",&own)] { 
      let cs=pliant::study::experiments::cases::cases(sk,1);
      for deg in (-18..18).map(|i| i*10) {
        print!("{nm} theta {deg}: ");
        for case in cs.iter().filter(|c| c.ours) {
          let o=pliant::study::experiments::outcome::Outcome::of(case,Column::Letter((deg as f64).to_radians())).unwrap();
          print!("{} {} {:.2}s g{:.3} soft {:.3} int {:.3} | ",case.id,o.drive.reached,o.drive.time(),o.drive.min_gamma(),o.soft_speed().unwrap_or(f64::NAN),o.intersection_speed().unwrap_or(f64::NAN));
        }
        println!();
      }
    }
}
fn best(n:&str,c:f64,sh:&[f64],of:&[f64],g:&[Vec<(f64,f64)>],t:f64) {
    let mut all=vec![];
    for i in 1..sh.len()-1 { for j in 1..of.len()-1 {
        let err=|p:(f64,f64)| { let e=(p.0-t).abs().max((p.1-t).abs()); if e.is_nan() {99.0} else {e} };
        let e=err(g[i][j]); let mut m:f64=0.0; for a in 0..3 { for b in 0..3 { m=m.max(err(g[i+a-1][j+b-1])); } }
        if e<3.0 { all.push((m,e,sh[i],of[j],g[i][j])); }
    }}
    all.sort_by(|a,b| a.0.total_cmp(&b.0));
    for a in all.iter().take(6) { println!("c {c} {n} worst near {:.1} err {:.1} share {:.2} off {:.4} {:+.1}/{:+.1}",a.0,a.1,a.2,a.3,a.4.0,a.4.1); }
}
