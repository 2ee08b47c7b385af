#![allow(clippy::all, missing_docs)]
use pliant::study::{column::*, drive::*, measure::*, skill::*, world::*};
fn main() {
    let lasa = std::env::args().nth(1).map(std::path::PathBuf::from);
    let t=std::time::Instant::now();
    let skills = Skills::new(lasa.as_deref(), &|_| {}).unwrap();
    println!("learn {:?}", t.elapsed());
    let s=&skills.s;
    println!("start {:?} path {} mm k {}", s.start, s.path.len(), s.model.component.len());
    for i in 0..=20 { let p=s.place(i as f64/20.0); println!("{:.2} at {:.3} {:.3} heading {:.2} speed", i as f64/20.0, p.at.x,p.at.y,p.heading()); }
    let c: f64 = std::env::var("C").ok().and_then(|c|c.parse().ok()).unwrap_or(0.03);
    let sc=|w:&World,name:&str,col:Column| pliant::scene::Scene::parse_with_model(name,&w.toml(col).replace("c = 0.03",&format!("c = {c:?}")),&w.skill.text);
    let d=Driving::of(Robot::Lagging);
    let t=std::time::Instant::now();
    for share in [0.15,0.2,0.25,0.3,0.35,0.4,0.45,0.5,0.55,0.6,0.65,0.7,0.75,0.8] {
        print!("A {share:.2}: ");
        for off in [-0.05,-0.04,-0.03,-0.02,-0.01,0.0,0.01,0.02,0.03,0.04,0.05] {
            let p=s.place(share);
            let w=World::new(s, vec![Body::new("cylinder",[0.04,0.04],1.5,p.at+p.left()*off,0.0)]);
            let mut sp=vec![]; 
            for c in [Column::Pliant, Column::Original] {
                match sc(&w,"a",c) { Ok(sc)=>{ let r=drive(&sc,&s.start,&d,None).unwrap(); sp.push((mean_speed(&r,|s|s.layers==1).unwrap_or(f64::NAN), r.reached, r.min_gamma()));} Err(e)=>{ sp.push((f64::NAN,false,0.0)); if off==0.0 {print!("{e} ")} } }
            }
            print!("{:+.0}{} ", change_percent(sp[0].0,sp[1].0), if sp.iter().all(|x|x.1&&x.2>1.0) {""} else {"!"});
        }
        println!();
    }
    println!("{:?}", t.elapsed());
    // B: cylinder on one side, ellipse on the other, gap between cores
    for i in 0..20 { let p=s.place(i as f64/20.0); let m=pliant_core::Motion::Lpv(s.model.certify::<f64,2>().unwrap()); print!("{:.2} ", m.velocity(&p.at).norm()); } println!();
    for side in [1.0,-1.0] { for tilt in [0.0, 0.4, -0.4] { for gap in [0.015,0.02,0.025,0.03] {
      print!("B side {side} tilt {tilt} gap {gap}: ");
      for share in [0.25,0.3,0.35,0.4,0.45,0.5,0.55,0.6,0.65,0.7,0.75] {
        let p=s.place(share); let n=p.left()*side;
        let mut e=Body::new("ellipse",[0.08,0.04],1.5,p.at,p.heading()+tilt);
        e.center = p.at - n*(gap/2.0+e.reach(&n));
        let w=World::new(s, vec![Body::new("cylinder",[0.04,0.04],1.5,p.at+n*(gap/2.0+0.04),0.0), e]);
        let mut sp=vec![];
        for c in [Column::Pliant, Column::Original] {
            match sc(&w,"b",c) { Ok(sc)=>{ let r=drive(&sc,&s.start,&d,None).unwrap(); sp.push((mean_speed(&r,|s|s.layers==2).unwrap_or(f64::NAN), r.reached, r.min_gamma()));} Err(_)=>sp.push((f64::NAN,false,0.0)) }
        }
        print!("{:+.0}{} ", change_percent(sp[0].0,sp[1].0), if sp.iter().all(|x|x.1&&x.2>1.0) {""} else {"!"});
      }
      println!();
    }}}
}
